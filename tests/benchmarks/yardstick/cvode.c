/* Steps of CVODE called from C: what `python -m tests.benchmarks.cvode_steps` compares with.

   The oscillator of oscillator.h at its barrier, smooth stretch after smooth stretch: each from
   a state given to a time given, with a row of the history at each of the times given. Nothing
   is looked for on the way. The functions of the library are handed over by address, so that it
   is the very library that eventpound has loaded. */

#include <math.h>

#include "oscillator.h"

enum { ONE_STEP = 2, COLUMNS = 7 };

typedef struct {
    int (*step)(void *memory, double stop, void *vector, double *reached, int task);
    int (*interpolate)(void *memory, double t, int derivative, void *vector);
    int (*begin)(void *memory, double t, void *vector);
    int (*set_stop)(void *memory, double stop);
    double *(*values)(void *vector);
    void *memory, *vector, *look;
} Integrator;

typedef struct {
    int count;
    const double *start, *end, *state; /* of each stretch: times (s), and u, v, z */
    int rows;
    const double *times;
    double *table; /* rows of t, a_g, u, v, absolute acceleration, z, spring force */
} Run;

static double ground(const Problem *p, double t) {
    if (t > p->duration) return 0.0;
    return p->cosine * cos(p->omega * t) + p->sine * sin(p->omega * t);
}

static double z_rate(const Problem *p, double v, double z) {
    double kappa = (v > 0.0) == (z > 0.0) ? 1.0 : 0.0;
    return v / p->yield_displacement * (1.0 - kappa * pow(fabs(z), 20.0));
}

/* What the right-hand side is handed, and the rate of (u, v, z). */
typedef struct {
    const Problem *problem;
    const Integrator *integrator;
} Data;

int rate_of_state(double t, void *state, void *rate, void *data) {
    const Data *d = data;
    const Problem *p = d->problem;
    const double *y = d->integrator->values(state);
    double *dy = d->integrator->values(rate);
    dy[0] = y[1];
    dy[1] = -(p->stiffness * y[0] + p->strength * y[2]) / p->mass - ground(p, t);
    dy[2] = z_rate(p, y[1], y[2]);
    return 0;
}

static void write_row(const Problem *p, double t, const double *y, double *row) {
    double force = p->stiffness * y[0] + p->strength * y[2];
    row[0] = t;
    row[1] = ground(p, t);
    row[2] = y[0];
    row[3] = y[1];
    row[4] = -force / p->mass;
    row[5] = y[2];
    row[6] = force;
}

/* Steps taken, or minus one where CVODE fails. */
long follow(const Problem *p, const Integrator *c, const Run *run) {
    long steps = 0;
    int row = 0;
    double *y = c->values(c->vector);
    for (int i = 0; i < run->count; i++) {
        double t = run->start[i], end = run->end[i];
        for (int k = 0; k < 3; k++) y[k] = run->state[3 * i + k];
        c->begin(c->memory, t, c->vector);
        c->set_stop(c->memory, end);
        while (t < end) {
            if (c->step(c->memory, end, c->vector, &t, ONE_STEP) < 0) return -1;
            steps++;
            for (; row < run->rows && run->times[row] <= t; row++) {
                c->interpolate(c->memory, run->times[row], 0, c->look);
                write_row(p, run->times[row], c->values(c->look), run->table + COLUMNS * row);
            }
        }
    }
    return steps;
}
