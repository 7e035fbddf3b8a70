/* The loading curve of the Bouc-Wen law: while u' keeps its sign sigma,
 *
 *     sigma z = Phi(xi),   Phi' = 1 - Phi^20 for Phi > 0,   Phi = xi for xi < 0,
 *
 * with xi = xi_r + sigma (u - u_r) / u_y since the last reversal r. Phi is kept as
 * Taylor expansions about nodes, good to rounding.
 */
#ifndef BACKBONE_H
#define BACKBONE_H

#include <math.h>

#define EXPONENT 20
#define NODES_PER_UNIT 64
#define FIRST_NODE 12 /* below 12/64, xi - Phi = xi^21/21 is less than rounding */
#define LAST_NODE 224 /* above 224/64, Phi is 1 to rounding */
#define TERMS 12      /* radius of convergence 0.157, distance to a node 1/128 */

/* fmin and fmax, which compilers do not inline because of NaN. */
static inline double least(double a, double b) { return a < b ? a : b; }
static inline double most(double a, double b) { return a > b ? a : b; }

static double table[LAST_NODE - FIRST_NODE + 1][TERMS];
static double saturation_shift; /* 1 - Phi(xi) -> exp(-n (xi - shift)) */

/* Taylor coefficients of Phi about a point where it is phi: (k+1) Phi_{k+1} = [1 - P]_k
 * with P = Phi^n from n Phi' P = Phi P'. */
static void expand(long double phi, int terms, long double *c) {
    long double p[40];
    c[0] = phi;
    p[0] = powl(phi, EXPONENT);
    for (int k = 0; k + 1 < terms; k++) {
        c[k + 1] = ((k == 0) - p[k]) / (k + 1);
        long double sum = 0;
        for (int i = 1; i <= k + 1; i++)
            sum += c[i] * p[k + 1 - i] * (EXPONENT * i - (k + 1 - i));
        p[k + 1] = sum / ((k + 1) * phi);
    }
}

static void prepare_backbone(void) {
    const int terms = 30;
    const long double step = 1.0L / NODES_PER_UNIT;
    long double xi = FIRST_NODE * step;
    long double phi = xi - powl(xi, EXPONENT + 1) / (EXPONENT + 1), c[40];
    for (int i = 0; i <= LAST_NODE - FIRST_NODE; i++) {
        expand(phi, terms, c);
        for (int k = 0; k < TERMS; k++) table[i][k] = (double)c[k];
        if (i == 2 * NODES_PER_UNIT - FIRST_NODE)
            saturation_shift = (double)(2.0L + logl(1.0L - phi) / EXPONENT);
        phi = 0;
        for (int k = terms - 1; k >= 0; k--) phi = phi * step + c[k];
    }
}

static inline double backbone(double xi) {
    if (xi <= (double)FIRST_NODE / NODES_PER_UNIT) return xi;
    if (xi >= (double)LAST_NODE / NODES_PER_UNIT) return 1.0;
    int node = (int)(xi * NODES_PER_UNIT + 0.5);
    const double *c = table[node - FIRST_NODE];
    double d = xi - (double)node / NODES_PER_UNIT;
    double d2 = d * d, d4 = d2 * d2;
    double low = (c[0] + c[1] * d) + d2 * (c[2] + c[3] * d);
    double middle = (c[4] + c[5] * d) + d2 * (c[6] + c[7] * d);
    double high = (c[8] + c[9] * d) + d2 * (c[10] + c[11] * d);
    return low + d4 * (middle + d4 * high);
}

/* xi with Phi(xi) = phi; at most `largest`, from where the curve counts as saturated. */
static double inverse_backbone(double phi, double largest) {
    if (phi <= (double)FIRST_NODE / NODES_PER_UNIT) return phi;
    if (phi >= backbone(largest)) return largest;
    /* Phi is concave: Newton's method converges from the left, where Phi is too small. */
    double xi = phi;
    for (int i = 0; i < 60; i++) {
        double value = backbone(xi), slope = 1.0 - pow(value, EXPONENT);
        double change = (phi - value) / slope;
        xi += change;
        if (fabs(change) <= 1e-15 * (1.0 + 1.0 / slope)) break;
    }
    return least(xi, largest);
}

/* Where the curve is straight, and where it is saturated, to within eta. */
static inline double end_of_line(double eta) {
    return pow((EXPONENT + 1) * eta, 1.0 / (EXPONENT + 1));
}

static inline double start_of_saturation(double eta) {
    return least(saturation_shift - log(eta) / EXPONENT, (double)LAST_NODE / NODES_PER_UNIT);
}

#endif
