/* Taylor series stepper with z eliminated: the method of the solver "fast", written for
 * the oscillator of oscillator.h alone. Unknown is the gap g = delta - u, which keeps its
 * relative accuracy at an impact and is exactly zero there:
 *
 *     g'' = (k (delta - g) + Q z) / m + a_g
 *
 * A stretch is a motion in one direction sigma (of u). A step ends at the end of a
 * stretch, at the barrier, where the loading curve stops being straight, or at a break of
 * the ground motion.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "backbone.h"
#include "oscillator.h"

#define MOST 32 /* coefficients of a series */
#define LEAST_ORDER 8
#define LARGEST_ORDER 20

enum region { STRAIGHT, KNEE, SATURATED };
enum end { FREE, STOP, REVERSAL, BARRIER, BORDER };

typedef struct {
    const Problem *p;
    Answer *answer;
    double K, q, delta; /* k/m, Q/m */
    double tolerance;
    double end_of_line, start_of_saturation;
    int smooth_order, knee_order;
    double t, g, rate;     /* rate = g' */
    double z;              /* at t */
    double sigma;
    double xi, g_anchor, xi_anchor;
    enum region region;
    int detaching;         /* g'' is exactly zero at t */
    double horizon;        /* length in which the next event is expected (s) */
    double fastest;
    int sample;            /* the present one of the record */
    double stop;           /* the next break of the ground motion */
    double c[MOST];        /* series of g */
    double zs[MOST];       /* series of z in the knee */
    double a[2];           /* ground acceleration and its rate at t */
    int quiet;             /* the ground motion is over */
} Run;

/* A step is given SHARE of the tolerance; the curve counts as straight and as saturated to
 * within ETA of it. Times at equal error hardly depend on either, nor on the orders: two
 * more or less change them by a few per cent. */
static const double SHARE = 0.1, ETA = 0.1;

void prepare(void) { prepare_backbone(); }

/* ---- ground motion ------------------------------------------------------------ */

static void ground_at(Run *r) {
    const Problem *p = r->p;
    if (r->quiet) {
        r->a[0] = r->a[1] = 0.0;
    } else if (p->samples) {
        const double *s = p->record + r->sample;
        r->a[1] = (s[1] - s[0]) / p->sample_step;
        r->a[0] = s[0] + r->a[1] * (r->t - r->sample * p->sample_step);
    } else {
        double si = sin(p->omega * r->t), co = cos(p->omega * r->t);
        r->a[0] = p->cosine * co + p->sine * si;
        r->a[1] = p->omega * (p->sine * co - p->cosine * si);
    }
}

static void next_stop(Run *r) {
    const Problem *p = r->p;
    if (p->samples) {
        r->quiet = r->sample + 1 >= p->samples;
        r->stop = r->quiet ? p->end : least((r->sample + 1) * p->sample_step, p->end);
    } else {
        r->quiet = r->t >= p->duration;
        r->stop = r->quiet ? p->end : least(p->duration, p->end);
    }
}

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
    double *c = r->c, K = r->K;
    double w2 = r->p->samples || r->quiet ? 0.0 : r->p->omega * r->p->omega;
    double a0 = r->a[0], a1 = r->a[1];
    c[0] = r->g;
    c[1] = r->rate;
    c[2] = 0.5 * (K * (r->delta - r->g) + r->q * r->z + a0);
    if (r->detaching) c[2] = 0.0;
    if (r->region == STRAIGHT) K += r->q / r->p->yield_displacement;
    double power = wanted;
    int small = 0, order = r->smooth_order;
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
    double *c = r->c, K = r->K, q = r->q;
    double w2 = r->p->samples || r->quiet ? 0.0 : r->p->omega * r->p->omega;
    double a0 = r->a[0], a1 = r->a[1];
    double scale = -1.0 / r->p->yield_displacement, over = 1.0 / r->z;
    double z2 = r->z * r->z, z4 = z2 * z2, z8 = z4 * z4;
    double lift, power = wanted;
    int small = 0, reached = order;
    c[0] = r->g;
    c[1] = r->rate;
    c[2] = r->detaching ? 0.0 : 0.5 * (K * (r->delta - r->g) + q * r->z + a0);
    z[0] = r->zs[0] = r->z;
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
        r->zs[k + 1] = z[k + 1];
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

/* ---- stretches ---------------------------------------------------------------- */

static double acceleration(const Run *r) { /* g'' */
    return r->K * (r->delta - r->g) + r->q * r->z + r->a[0];
}

/* Direction and branch of the loading curve from g, g' and z. */
static void begin_stretch(Run *r) {
    double pull = r->detaching ? 0.0 : acceleration(r);
    double lead = r->rate != 0.0 ? r->rate : pull;
    if (lead == 0.0) lead = r->a[1];
    r->sigma = lead > 0.0 ? -1.0 : 1.0;
    r->xi = inverse_backbone(r->sigma * r->z, r->start_of_saturation);
    r->g_anchor = r->g;
    r->xi_anchor = r->xi;
    r->region = r->xi < r->end_of_line ? STRAIGHT
              : r->xi < r->start_of_saturation ? KNEE : SATURATED;
    r->horizon = HUGE_VAL;
    if (r->rate > 0.0 && pull < 0.0) r->horizon = -1.5 * r->rate / pull;
    if (r->rate == 0.0 && pull < 0.0 && r->g > 0.0) r->horizon = 1.5 * sqrt(-2.0 * r->g / pull);
}

static void seen(Run *r) {
    double u = r->delta - r->g;
    if (u < r->answer->u_min) r->answer->u_min = u;
    if (u > r->answer->u_max) r->answer->u_max = u;
}

/* First instant after t, to `stop`, at which a body resting on the barrier is let go:
 * g'' = base + a_g rises through zero. */
static double release(const Run *r, double base) {
    const Problem *p = r->p;
    if (r->quiet) return r->stop;
    if (p->samples) {
        double s = r->a[1] > 0.0 ? -(base + r->a[0]) / r->a[1] : HUGE_VAL;
        return least(r->t + s, r->stop);
    }
    /* a_g = A cos(omega t - phase) rises through -base at omega t = phase - acos(-base/A). */
    double A = hypot(p->cosine, p->sine), phase = atan2(p->sine, p->cosine);
    if (fabs(base) >= A) return r->stop;
    double angle = phase - acos(-base / A);
    angle += 2.0 * M_PI * ceil((p->omega * r->t - angle) / (2.0 * M_PI));
    return least(angle / p->omega, r->stop);
}

static void impact(Run *r) {
    Answer *answer = r->answer;
    double speed = -r->rate;
    r->g = 0.0;
    r->fastest = most(r->fastest, speed);
    if (answer->listed < LISTED) {
        answer->time[answer->listed] = r->t;
        answer->speed[answer->listed++] = speed;
    }
    answer->impacts++;
    r->rate = r->p->restitution * speed;
    if (r->rate <= 1e-15 * r->fastest) r->rate = 0.0;
}

static int resting(const Run *r) {
    return r->g == 0.0 && r->rate == 0.0 && !r->detaching && acceleration(r) < 0.0;
}

static void rest(Run *r) {
    double base = r->K * r->delta + r->q * r->z;
    if (r->answer->rest < 0.0 || r->answer->detachment >= 0.0) {
        r->answer->rest = r->t;
        r->answer->detachment = -1.0;
    }
    double when = release(r, base);
    r->t = when;
    if (when < r->stop) {
        r->detaching = 1;
        r->answer->detachment = when;
        ground_at(r);
        begin_stretch(r);
    }
}

/* One step within a stretch. */
static enum end step(Run *r) {
    double remaining = r->stop - r->t, wanted = least(remaining, r->horizon), h;
    double u = r->delta - r->g;
    double scale = most(r->p->length * r->p->rate + fabs(r->rate), r->p->rate * fabs(u));
    double tolerance = r->tolerance * scale;
    int knee = r->region == KNEE;
    int order = knee ? expanded[r->knee_order - LEAST_ORDER](r, tolerance, wanted, &h)
                     : smooth_series(r, tolerance, wanted, &h);
    enum end end = FREE;
    if (h >= wanted) {
        h = wanted;
        if (wanted == remaining) end = STOP;
    }
    r->answer->steps++;
    r->answer->knee_steps += knee;
    double turn = turning_point(r->c, order, h);
    if (turn >= 0.0) {
        h = turn;
        end = REVERSAL;
    }
    double rate, xi, g = horner2(r->c, order, h, &rate);
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
        h = crossing(r->c, order, h, level);
        end = beyond;
        g = horner2(r->c, order, h, &rate);
    }
    for (;;) {
        xi = r->xi_anchor + r->sigma * (r->g_anchor - g) / uy;
        if (!knee) break;
        /* The series must lie on the loading curve at its end. */
        double error = fabs(horner(r->zs, order - 2, h) - r->sigma * backbone(xi));
        if (r->q * error * h <= tolerance * (order - 1)) break;
        r->answer->refused++;
        end = FREE;
        h *= 0.7;
        g = horner2(r->c, order, h, &rate);
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

static void pass_stop(Run *r) {
    if (r->p->samples) r->sample++;
    next_stop(r);
    ground_at(r);
    /* The acceleration may have jumped, so a body at rest may go anywhere. */
    if (r->rate == 0.0 && !resting(r)) begin_stretch(r);
}

static void solve_once(const Problem *p, Answer *answer) {
    Run run, *r = &run;
    memset(&run, 0, sizeof run);
    memset(answer, 0, offsetof(Answer, time));
    answer->rest = answer->detachment = -1.0;
    r->p = p;
    r->answer = answer;
    r->K = p->stiffness / p->mass;
    r->q = p->strength / p->mass;
    r->delta = p->gap;
    r->tolerance = SHARE * p->rtol;
    double digits = -log10(p->rtol);
    r->smooth_order = (int)least(8.0 + digits, MOST - 2);
    r->knee_order = (int)least(most(4.0 + digits, LEAST_ORDER), LARGEST_ORDER);
    double eta = most(ETA * p->rtol, 1e-16);
    r->end_of_line = r->q == 0.0 ? HUGE_VAL : end_of_line(eta);
    r->start_of_saturation = start_of_saturation(eta);
    r->g = p->gap;
    next_stop(r);
    ground_at(r);
    begin_stretch(r);
    for (long count = 0; r->t < p->end; count++) {
        if (count > 10000000) {
            answer->trouble = 1;
            break;
        }
        if (resting(r)) {
            rest(r);
            if (r->t >= r->stop) pass_stop(r);
            continue;
        }
        enum end end = step(r);
        switch (end) {
        case REVERSAL:
            ground_at(r);
            seen(r);
            begin_stretch(r);
            break;
        case BARRIER:
            ground_at(r);
            impact(r);
            seen(r);
            if (!resting(r)) begin_stretch(r);
            break;
        case STOP:
            pass_stop(r);
            break;
        default:
            ground_at(r);
        }
    }
    seen(r);
    answer->u = r->delta - r->g;
    answer->v = -r->rate;
    answer->z = r->z;
}

void solve(const Problem *problem, Answer *answer, int repeats) {
    for (int i = 0; i < repeats; i++) solve_once(problem, answer);
}
