/* Taylor series stepper with z eliminated: the method of the solver "fast", written for
 * the oscillator of oscillator.h alone. Steps also end where the loading curve stops being
 * straight.
 */
#define MOST 32 /* coefficients of a series */
#define LEAST_ORDER 8
#define LARGEST_ORDER 20

typedef struct {
    int smooth_order, knee_order;
    double c[MOST], z[MOST]; /* series of g, and of z in the knee */
} Method;

#include "stretches.h"

/* A step is given SHARE of the tolerance; the curve counts as straight and as saturated to
 * within ETA of it. Times at equal error hardly depend on either, nor on the orders: two
 * more or less change them by a few per cent. */
static const double SHARE = 0.1, ETA = 0.1;

/* ---- series ------------------------------------------------------------------- */

static const double inverse[2 * MOST] = {
    0, 1. / 1, 1. / 2, 1. / 3, 1. / 4, 1. / 5, 1. / 6, 1. / 7, 1. / 8, 1. / 9, 1. / 10, 1. / 11,
    1. / 12, 1. / 13, 1. / 14, 1. / 15, 1. / 16, 1. / 17, 1. / 18, 1. / 19, 1. / 20, 1. / 21,
    1. / 22, 1. / 23, 1. / 24, 1. / 25, 1. / 26, 1. / 27, 1. / 28, 1. / 29, 1. / 30, 1. / 31,
    1. / 32, 1. / 33};

/* Length of a step from the last two coefficients of g', and the order used: fewer terms
 * where `wanted` is reached with them. */
static double bounded(double coefficient, int k, double tolerance, double power) {
    /* (tolerance / (k c))^(1/(k-1)) with power = 1/(k-1) */
    return coefficient == 0.0 ? HUGE_VAL : exp2(log2(tolerance / (k * fabs(coefficient))) * power);
}

/* Coefficients of g from the straight or saturated law; returns the order. */
static int smooth_series(Run *r, double tolerance, double wanted, double *length) {
    double *c = r->method.c, K = r->K;
    double w2 = r->p->samples || r->quiet ? 0.0 : r->p->omega * r->p->omega;
    double a0 = r->a[0], a1 = r->a[1];
    c[0] = r->g;
    c[1] = r->rate;
    c[2] = 0.5 * (K * (r->delta - r->g) + r->q * r->z + a0);
    if (r->detaching) c[2] = 0.0;
    if (r->region == STRAIGHT) K += r->q / r->p->yield_displacement;
    double power = wanted;
    int small = 0, order = r->method.smooth_order;
    for (int k = 1; k + 2 <= order; k++) {
        c[k + 2] = (a1 - K * c[k]) * (inverse[k + 1] * inverse[k + 2]);
        double a2 = -w2 * a0 * (inverse[k] * inverse[k + 1]);
        a0 = a1;
        a1 = a2;
        power *= wanted;
        small = (k + 2) * fabs(c[k + 2]) * power <= tolerance ? small + 1 : 0;
        if (small == 2) {
            *length = wanted;
            return k + 2;
        }
    }
    *length = least(bounded(c[order], order, tolerance, inverse[order - 1]),
                   bounded(c[order - 1], order - 1, tolerance, inverse[order - 2]));
    return order;
}

/* The same in the knee, with the series of z:
 * z' = -(g'/u_y) (1 - P), P = |z|^n from n z' P = z P'. The order is a constant where this
 * is expanded, so that the sums are written out; in each, the term that was computed last
 * is added last. */
static inline __attribute__((always_inline)) int knee_series(Run *r, double tolerance,
                                                             double wanted, double *length,
                                                             const int order) {
    double z[MOST], P[MOST];
    double speed[MOST], resistance[MOST]; /* -g'/u_y; 1 - P */
    double *c = r->method.c, K = r->K, q = r->q;
    double w2 = r->p->samples || r->quiet ? 0.0 : r->p->omega * r->p->omega;
    double a0 = r->a[0], a1 = r->a[1];
    double scale = -1.0 / r->p->yield_displacement, over = 1.0 / r->z;
    double z2 = r->z * r->z, z4 = z2 * z2, z8 = z4 * z4;
    double lift, power = wanted;
    int small = 0, reached = order;
    c[0] = r->g;
    c[1] = r->rate;
    c[2] = r->detaching ? 0.0 : 0.5 * (K * (r->delta - r->g) + q * r->z + a0);
    z[0] = r->method.z[0] = r->z;
    P[0] = z8 * z8 * z4;
    lift = EXPONENT * P[0] * over;
    resistance[0] = 1.0 - P[0];
#pragma GCC unroll 32
    for (int k = 0; k + 3 <= order; k++) {
        speed[k] = scale * (k + 1) * c[k + 1];
        double sum = 0.0, other = 0.0;
#pragma GCC unroll 32
        for (int j = k; j >= 1; j--) {
            double term = speed[j] * resistance[k - j];
            if (j & 1) sum += term;
            else other += term;
        }
        z[k + 1] = (sum + other) * inverse[k + 1] + resistance[k] * (speed[0] * inverse[k + 1]);
        r->method.z[k + 1] = z[k + 1];
        c[k + 3] = (a1 - K * c[k + 1] + q * z[k + 1]) * (inverse[k + 2] * inverse[k + 3]);
        double a2 = -w2 * a0 * (inverse[k + 1] * inverse[k + 2]);
        a0 = a1;
        a1 = a2;
        power *= wanted;
        small = (k + 3) * fabs(c[k + 3]) * power <= tolerance ? small + 1 : 0;
        if (small == 2) {
            reached = k + 3;
            break;
        }
        /* (k+1) z_0 P_{k+1} = sum_i z_i P_{k+1-i} ((n + 1) i - (k + 1)) */
        sum = other = 0.0;
#pragma GCC unroll 32
        for (int i = k; i >= 1; i--) {
            double term = z[i] * P[k + 1 - i] * ((EXPONENT + 1) * i - (k + 1));
            if (i & 1) sum += term;
            else other += term;
        }
        P[k + 1] = (sum + other) * (over * inverse[k + 1]) + lift * z[k + 1];
        resistance[k + 1] = -P[k + 1];
    }
    *length = wanted;
    if (small < 2)
        *length = least(bounded(c[order], order, tolerance, inverse[order - 1]),
                        bounded(c[order - 1], order - 1, tolerance, inverse[order - 2]));
    return reached;
}

#define EXPANDED(N) \
    static int knee_series_##N(Run *r, double tolerance, double wanted, double *length) { \
        return knee_series(r, tolerance, wanted, length, N); \
    }
EXPANDED(8) EXPANDED(9) EXPANDED(10) EXPANDED(11) EXPANDED(12) EXPANDED(13) EXPANDED(14)
EXPANDED(15) EXPANDED(16) EXPANDED(17) EXPANDED(18) EXPANDED(19) EXPANDED(20)

static int (*const expanded[])(Run *, double, double, double *) = {
    knee_series_8,  knee_series_9,  knee_series_10, knee_series_11, knee_series_12,
    knee_series_13, knee_series_14, knee_series_15, knee_series_16, knee_series_17,
    knee_series_18, knee_series_19, knee_series_20};

static double horner(const double *c, int order, double s) {
    double value = c[order];
    for (int k = order - 1; k >= 0; k--) value = value * s + c[k];
    return value;
}

static double horner2(const double *c, int order, double s, double *slope) {
    double value = c[order], first = 0.0;
    for (int k = order - 1; k >= 0; k--) {
        first = first * s + value;
        value = value * s + c[k];
    }
    *slope = first;
    return value;
}

/* ---- events in a step --------------------------------------------------------- */

/* First zero of g' in (0, h], or a negative number. Leading zeros are divided out; then
 * w + w' s - b s^2/2 with b >= |w''| bounds w from below, and its root is never past the
 * zero of w, to which it converges quadratically. */
static double turning_point(const double *c, int order, double h) {
    double w[MOST];
    int first = 1;
    while (first <= order && c[first] == 0.0) first++;
    if (first >= order) return -1.0;
    int n = order - first;
    double sign = c[first] > 0.0 ? 1.0 : -1.0;
    for (int k = 0; k <= n; k++) w[k] = sign * (first + k) * c[first + k];
    double rest = 0.0;
    for (int k = n; k >= 1; k--) rest = rest * h + fabs(w[k]);
    if (rest * h < w[0]) return -1.0;
    double bend = 0.0;
    for (int k = n; k >= 2; k--) bend = bend * h + k * (k - 1) * fabs(w[k]);
    double s = 0.0, value = w[0], slope = w[1];
    for (int i = 0; i < 200; i++) {
        double change;
        if (slope < 0.0)
            change = 2.0 * value / (sqrt(slope * slope + 2.0 * bend * value) - slope);
        else
            change = bend > 0.0 ? (slope + sqrt(slope * slope + 2.0 * bend * value)) / bend : h;
        s += change;
        if (s >= h) {
            /* The bound is of the step: what is beyond does not matter. */
            return horner(w, n, h) < 0.0 ? h : -1.0;
        }
        if (change <= 4e-16 * s) return s;
        value = horner2(w, n, s, &slope);
        if (value <= 0.0) return s;
    }
    return s;
}

/* Where g, falling or rising throughout (0, h), passes level: Newton with a bracket. */
static double crossing(const double *c, int order, double h, double level) {
    double low = 0.0, high = h, s = h;
    double fall = c[0] > level || (c[0] == level && c[1] > 0.0) ? 1.0 : -1.0;
    for (int i = 0; i < 100; i++) {
        double slope, value = horner2(c, order, s, &slope) - level;
        if (value * fall > 0.0) low = s;
        else high = s;
        double next = s - value / slope;
        if (!(next > low && next < high)) {
            if (value == 0.0) return s;
            next = 0.5 * (low + high);
        }
        if (fabs(next - s) <= 4e-16 * s) return next;
        s = next;
    }
    return s;
}

static void choose_method(Run *r) {
    r->tolerance = SHARE * r->p->rtol;
    double digits = -log10(r->p->rtol);
    r->method.smooth_order = (int)least(8.0 + digits, MOST - 2);
    r->method.knee_order = (int)least(most(4.0 + digits, LEAST_ORDER), LARGEST_ORDER);
    double eta = most(ETA * r->p->rtol, 1e-16);
    r->end_of_line = r->q == 0.0 ? HUGE_VAL : end_of_line(eta);
    r->start_of_saturation = start_of_saturation(eta);
}

/* One step within a stretch. */
static enum end step(Run *r) {
    double remaining = r->stop - r->t, wanted = least(remaining, r->horizon), h;
    double u = r->delta - r->g;
    double scale = most(r->p->length * r->p->rate + fabs(r->rate), r->p->rate * fabs(u));
    double tolerance = r->tolerance * scale;
    int knee = r->region == KNEE;
    int order = knee ? expanded[r->method.knee_order - LEAST_ORDER](r, tolerance, wanted, &h)
                     : smooth_series(r, tolerance, wanted, &h);
    enum end end = FREE;
    if (h >= wanted) {
        h = wanted;
        if (wanted == remaining) end = STOP;
    }
    r->answer->steps++;
    r->answer->knee_steps += knee;
    double turn = turning_point(r->method.c, order, h);
    if (turn >= 0.0) {
        h = turn;
        end = REVERSAL;
    }
    double rate, xi, g = horner2(r->method.c, order, h, &rate);
    double level = r->sigma > 0.0 ? 0.0 : HUGE_VAL;
    double uy = r->p->yield_displacement;
    enum end beyond = BARRIER;
    if (r->region == STRAIGHT) {
        double border = r->g_anchor - r->sigma * uy * (r->end_of_line - r->xi_anchor);
        if (r->sigma > 0.0 ? border > level : border < level) {
            level = border;
            beyond = BORDER;
        }
    }
    if (r->sigma > 0.0 ? g <= level : g >= level) {
        h = crossing(r->method.c, order, h, level);
        end = beyond;
        g = horner2(r->method.c, order, h, &rate);
    }
    for (;;) {
        xi = r->xi_anchor + r->sigma * (r->g_anchor - g) / uy;
        if (!knee) break;
        /* The series must lie on the loading curve at its end. */
        double error = fabs(horner(r->method.z, order - 2, h) - r->sigma * backbone(xi));
        if (r->q * error * h <= tolerance * (order - 1)) break;
        r->answer->refused++;
        end = FREE;
        h *= 0.7;
        g = horner2(r->method.c, order, h, &rate);
    }
    r->t = end == STOP ? r->stop : r->t + h;
    r->horizon -= h;
    if (r->horizon <= 0.0) r->horizon = HUGE_VAL;
    r->detaching = 0;
    r->g = g;
    r->rate = rate;
    r->xi = xi;
    if (r->region == STRAIGHT) r->z = r->sigma * xi;
    else if (knee) r->z = r->sigma * backbone(xi);
    if (end == BARRIER) r->g = 0.0;
    if (end == REVERSAL) r->rate = 0.0;
    if (end == BORDER) {
        r->region = KNEE;
        r->z = r->sigma * backbone(xi);
    }
    if (knee && xi >= r->start_of_saturation) {
        r->region = SATURATED;
        r->z = r->sigma;
    }
    return end;
}
