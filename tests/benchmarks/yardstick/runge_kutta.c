/* The method of the first prototype, an explicit Runge-Kutta program for the oscillator of
 * oscillator.h alone: for a pulse DOP853 on (g, g') with z eliminated, for a record DOPRI5
 * on (g, g', z), stepping to every sample. Reversals and impacts show in the signs of g'
 * and g at the end of a step, which is then taken again to the root, by Newton's method.
 * Two reversals within one step are missed, as in the prototype; taylor.c misses none.
 */
typedef struct {
    int carried; /* z is integrated */
    double h;    /* proposed length of the next step */
} Method;

#include "stretches.h"
#include "tableaus.h"

typedef struct {
    double g, rate, z;
} State;

static inline double ground(const Run *r, double s) {
    const Problem *p = r->p;
    if (p->samples || r->quiet) return r->a[0] + r->a[1] * s;
    return p->cosine * cos(p->omega * (r->t + s)) + p->sine * sin(p->omega * (r->t + s));
}

static inline double eliminated(const Run *r, double g) {
    double over = 1.0 / r->p->yield_displacement;
    return r->sigma * backbone(r->xi_anchor + r->sigma * (r->g_anchor - g) * over);
}

static inline double yielding(const Run *r, double z) {
    double z2 = z * z, z4 = z2 * z2, z8 = z4 * z4;
    return r->sigma * z > 0.0 ? z8 * z8 * z4 : 0.0;
}

static inline State rates(const Run *r, double s, State y, int carried) {
    double z = carried ? y.z : eliminated(r, y.g);
    State d = {y.rate, r->K * (r->delta - y.g) + r->q * z + ground(r, s), 0.0};
    if (carried) d.z = -y.rate * (1.0 - yielding(r, z)) / r->p->yield_displacement;
    return d;
}

/* Stages of a step of length h from y; returns its end, and the stages in k. */
static inline __attribute__((always_inline)) State stages(
    const Run *r, State y, State first, double h, const int n, const double (*a)[n],
    const double *b, const double *c, const int carried, State *k) {
    k[0] = first;
#pragma GCC unroll 16
    for (int i = 1; i < n; i++) {
        State sum = {0, 0, 0};
#pragma GCC unroll 16
        for (int j = 0; j < i; j++) {
            if (a[i][j] == 0.0) continue;
            sum.g += a[i][j] * k[j].g;
            sum.rate += a[i][j] * k[j].rate;
            if (carried) sum.z += a[i][j] * k[j].z;
        }
        State at = {y.g + h * sum.g, y.rate + h * sum.rate, y.z + h * sum.z};
        k[i] = rates(r, c[i] * h, at, carried);
    }
    State sum = {0, 0, 0};
#pragma GCC unroll 16
    for (int i = 0; i < n; i++) {
        if (b[i] == 0.0) continue;
        sum.g += b[i] * k[i].g;
        sum.rate += b[i] * k[i].rate;
        if (carried) sum.z += b[i] * k[i].z;
    }
    return (State){y.g + h * sum.g, y.rate + h * sum.rate, y.z + h * sum.z};
}

static State take(const Run *r, State y, State first, double h, State *k) {
    if (r->method.carried)
        return stages(r, y, first, h, 6, dopri5_a, dopri5_b, dopri5_c, 1, k);
    return stages(r, y, first, h, 12, dop853_a, dop853_b, dop853_c, 0, k);
}

/* Error of a step as a multiple of the tolerance, and the power of h it grows with. */
static double excess(const Run *r, const State *k, State end, double h, double *power) {
    double width = r->p->length + fabs(r->delta - r->g);
    double speed = r->p->length * r->p->rate + fabs(r->rate);
    if (r->method.carried) {
        State last = rates(r, h, end, 1), e = {0, 0, 0};
        for (int i = 0; i < 7; i++) {
            State at = i < 6 ? k[i] : last;
            e.g += dopri5_e[i] * at.g;
            e.rate += dopri5_e[i] * at.rate;
            e.z += dopri5_e[i] * at.z;
        }
        *power = 1.0 / 5;
        double worst = most(fabs(e.g) / width, fabs(e.rate) / speed);
        return h * most(worst, fabs(e.z)) / r->tolerance;
    }
    State e5 = {0, 0, 0}, e3 = {0, 0, 0};
    for (int i = 0; i < 12; i++) {
        e5.g += dop853_e5[i] * k[i].g;
        e5.rate += dop853_e5[i] * k[i].rate;
        e3.g += dop853_e3[i] * k[i].g;
        e3.rate += dop853_e3[i] * k[i].rate;
    }
    double fifth = e5.g * e5.g / (width * width) + e5.rate * e5.rate / (speed * speed);
    double third = e3.g * e3.g / (width * width) + e3.rate * e3.rate / (speed * speed);
    *power = 1.0 / 8;
    if (fifth == 0.0) return 0.0;
    return h * fifth / sqrt(2.0 * (fifth + 0.01 * third)) / r->tolerance;
}

/* Length of a step to the zero of g' (turning) or of g, within h, and its end. */
static double locate(const Run *r, State y, State first, double h, int turning, State *end) {
    State k[12];
    double low = 0.0, high = h;
    double guess = turning ? -y.rate / first.rate : h;
    if (turning && !(guess > 0.0 && guess < h)) guess = h * y.rate / (y.rate - end->rate);
    double s = guess > 0.0 && guess < h ? guess : 0.5 * h;
    int down = !turning || r->sigma < 0.0;
    for (int i = 0; i < 60; i++) {
        *end = take(r, y, first, s, k);
        State rate = rates(r, s, *end, r->method.carried);
        double value = turning ? end->rate : end->g, slope = turning ? rate.rate : rate.g;
        if (down ? value > 0.0 : value < 0.0) low = s;
        else high = s;
        double next = s - value / slope;
        if (!(next > low && next < high)) {
            if (high - low <= 4e-16 * s || value == 0.0) return s;
            next = 0.5 * (low + high);
        }
        if (fabs(next - s) <= 1e-15 * s) return s;
        s = next;
    }
    return s;
}

static void choose_method(Run *r) {
    r->tolerance = 0.1 * r->p->rtol;
    r->method.carried = r->p->samples > 0;
    r->method.h = r->method.carried ? r->p->sample_step : 0.01 / r->p->rate;
    r->end_of_line = HUGE_VAL;
    r->start_of_saturation = (double)LAST_NODE / NODES_PER_UNIT;
}

static enum end step(Run *r) {
    State y = {r->g, r->rate, r->z}, k[12], to;
    State first = rates(r, 0.0, y, r->method.carried);
    if (r->detaching) first.rate = 0.0;
    double remaining = r->stop - r->t, h, power;
    enum end end = FREE;
    for (;;) {
        h = least(r->method.h, least(remaining, r->horizon));
        to = take(r, y, first, h, k);
        double error = excess(r, k, to, h, &power);
        double factor = error > 0.0 ? 0.9 * exp2(-power * log2(error)) : 6.0;
        double proposed = h * least(most(factor, 0.2), 6.0);
        if (error <= 1.0) {
            /* A step cut short says nothing against a longer one. */
            r->method.h = h < r->method.h ? most(proposed, r->method.h) : proposed;
            break;
        }
        r->method.h = proposed;
        r->answer->refused++;
    }
    r->answer->steps++;
    if (h == remaining) end = STOP;
    if (to.rate * r->sigma > 0.0) {
        h = locate(r, y, first, h, 1, &to);
        end = REVERSAL;
    }
    if (r->sigma > 0.0 && to.g <= 0.0) {
        h = locate(r, y, first, h, 0, &to);
        end = BARRIER;
    }
    r->t = end == STOP ? r->stop : r->t + h;
    r->horizon -= h;
    if (r->horizon <= 0.0) r->horizon = HUGE_VAL;
    r->detaching = 0;
    r->g = end == BARRIER ? 0.0 : to.g;
    r->rate = end == REVERSAL ? 0.0 : to.rate;
    r->z = r->method.carried ? to.z : eliminated(r, r->g);
    return end;
}
