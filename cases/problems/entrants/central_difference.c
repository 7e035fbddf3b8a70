/* Central differences with Newton's impact law at the ends of steps, contact by contact.

   cc -O2 -o central_difference central_difference.c -lm
   cat PROBLEM/problem.txt PROBLEM/motion.csv | ./central_difference STEP > out.csv

   STEP is in parts of the run. Velocities v live between the steps, w at them. Gaps overlap by
   part of a step; of several contacts one is struck after the other. An impact is two rows of one
   time. First order. Decks in plan it does not know. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define EACH(i, n) for (int i = 0; i < n; i++)
enum { MOST = 256, COMPRESSION = 0, EXTENSION, OFFSET, STRENGTH, YIELD, POWER, BETA, GAMMA, Z };
static double M[MOST], C[MOST][MOST], u[MOST], v[MOST], w[MOST], f[MOST], gap[MOST], eps[MOST];
static double W[MOST][MOST], B[MOST][MOST], spring[MOST][Z + 1], t0, a0, t1 = -INFINITY, a1;
static int N, S, K, more = 1;

static void get(double *x, int n) { EACH(i, n) if (scanf("%lf", x + i) != 1) exit(2); }
static double dot(double *a, double *b) { double x = 0; EACH(i, N) x += a[i] * b[i]; return x; }
static double ground(double t) { /* of motion.csv, read as time goes on */
    while (more && t1 <= t) t0 = t1, a0 = a1, more = scanf("%lf,%lf", &t1, &a1) == 2;
    return more && t0 > -INFINITY ? a0 + (a1 - a0) * (t - t0) / (t1 - t0) : 0;
}
static double flow(double *k, double x, double z) { /* what z becomes over x at the rate of z */
    double rate = k[BETA] + (x * z > 0 ? k[GAMMA] : -k[GAMMA]), most = k[BETA] + k[GAMMA];
    z = k[Z] + x / k[YIELD] * (1 - rate * pow(fabs(z), k[POWER]));
    return copysign(fmin(fabs(z), pow(most, -1 / k[POWER])), z);
}
static int strike(void) { /* closed contacts; whether any approached */
    int struck = 0;
    EACH(c, K) {
        double rate = dot(W[c], v), give = 0;
        if (gap[c] + dot(W[c], u) > 0 || rate >= -1e-12) continue;
        EACH(i, N) give += W[c][i] * W[c][i] / M[i];
        EACH(i, N) v[i] -= (1 + eps[c]) * rate * W[c][i] / give / M[i];
        struck = 1;
    }
    return struck;
}
static void row(double t) {
    printf("%.17g", t);
    EACH(i, 2 * N) printf(",%.17g", i < N ? u[i] : w[i - N]);
    EACH(j, S) if (spring[j][STRENGTH]) printf(",%.17g", spring[j][Z]);
    puts("");
}
int main(int argc, char **argv) {
    char line[1 << 16];
    double start, end, size = argc > 1 ? atof(argv[1]) : 1e-4;
    EACH(i, 2) fputs(fgets(line, sizeof line, stdin) ? line : "", stdout);
    if (scanf("%d%d%d%lf%lf", &N, &S, &K, &start, &end) != 5) return 2;
    EACH(i, N) get(M + i, 1), get(u + i, 1), get(v + i, 1), get(C[i], N);
    EACH(j, S) get(spring[j], Z + 1), get(B[j], N);
    EACH(c, K) get(gap + c, 1), get(eps + c, 1), get(W[c], N);
    char head[8] = "";
    if (scanf("%7s", head) != 1 || strcmp(head, "t,a_g")) /* of more sections, or the samples */
        return fputs("error: knows bodies on a line, no decks in plan\n", stderr), 3;
    long steps = 40 * ceil(1 / size / 40 - 1e-9); /* so that every moment is a step */
    long stride = steps / 40 % 25 ? 1 : steps / 1000; /* of rows, where no contact is near */
    double h = (end - start) / steps;
    for (long step = 0; step <= steps; step++) {
        double t = step < steps ? start + step * h : end, a_g = ground(t);
        EACH(i, N) f[i] = -M[i] * a_g - dot(C[i], v);
        EACH(j, S) {
            double *k = spring[j], x = dot(B[j], u) - k[OFFSET];
            x = k[x < 0 ? COMPRESSION : EXTENSION] * x + k[STRENGTH] * k[Z];
            EACH(i, N) f[i] -= B[j][i] * x;
        }
        EACH(i, N) w[i] = v[i] + (step ? 0.5 : 0) * h * f[i] / M[i];
        EACH(i, N) v[i] += (step % steps ? 1 : 0.5) * h * f[i] / M[i];
        int struck = strike(), rounds = struck ? 1000 : 0, near = struck;
        while (rounds-- && strike()); /* until none approaches */
        EACH(c, K) near |= gap[c] + dot(W[c], u) + stride * h * dot(W[c], w) < 0;
        if (near || step % stride == 0) row(t);
        EACH(i, struck * N) w[i] = v[i];
        if (struck) row(t);
        EACH(j, S) { /* the midpoint rule over the elongation of the step */
            double x = h * dot(B[j], v);
            spring[j][Z] = flow(spring[j], x, flow(spring[j], x / 2, spring[j][Z]));
        }
        EACH(i, N) u[i] += h * v[i];
    }
    return ferror(stdout);
}
