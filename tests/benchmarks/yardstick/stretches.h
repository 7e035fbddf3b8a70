/* What a run is but for its steps: the ground motion, directions and branches of the loading
 * curve, impacts, rest, and the loop. A program defines the type Method, with what its steps
 * keep, includes this, and defines choose_method and step.
 *
 * Unknown is the gap g = delta - u, which keeps its relative accuracy at an impact and is
 * exactly zero there:
 *
 *     g'' = (k (delta - g) + Q z) / m + a_g
 *
 * A stretch is a motion in one direction sigma (of u). A step ends at the end of a
 * stretch, at the barrier, or at a break of the ground motion.
 */
#ifndef STRETCHES_H
#define STRETCHES_H

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "backbone.h"
#include "oscillator.h"

enum region { STRAIGHT, KNEE, SATURATED };
enum end { FREE, STOP, REVERSAL, BARRIER, BORDER };

typedef struct {
    const Problem *p;
    Answer *answer;
    double K, q, delta; /* k/m, Q/m */
    double tolerance;
    double end_of_line, start_of_saturation;
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
    double a[2];           /* ground acceleration and its rate at t */
    int quiet;             /* the ground motion is over */
    Method method;
} Run;

static void choose_method(Run *r);
static enum end step(Run *r);

void prepare(void) { prepare_backbone(); }

/* For tests. */
double loading_curve(double xi) { return backbone(xi); }

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
    choose_method(r);
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

#endif
