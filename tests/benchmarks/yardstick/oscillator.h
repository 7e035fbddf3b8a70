/* One body of mass m on a Bouc-Wen spring F = k x + Q z to the ground, a rigid
 * barrier to its right, under a pulse or a sampled record, from rest:
 *
 *     m u'' + k u + Q z = -m a_g(t),    z' = (u'/u_y) (1 - kappa |z|^n)
 *
 * with n = 20, beta = gamma = 1/2: kappa = 1 while u' z > 0 and 0 while u' z < 0.
 */
#ifndef OSCILLATOR_H
#define OSCILLATOR_H

#define LISTED 64

typedef struct {
    double mass, stiffness, strength, yield_displacement; /* m, k, Q, u_y */
    double gap, restitution;
    double cosine, sine, omega, duration; /* a_g = cosine cos(omega t) + sine sin(omega t) */
    double sample_step;                   /* a record where samples > 0 */
    const double *record;
    int samples;
    double end;
    double length, rate; /* scales: length (m) and frequency (rad/s) of the motion */
    double rtol;
} Problem;

typedef struct {
    double u_min, u_max, u, v, z;
    double rest, detachment; /* time of the last one; negative where there is none */
    int impacts, listed;     /* counted, and listed below with time and closing speed */
    int steps, knee_steps, refused;
    int trouble; /* 1: did not end */
    double time[LISTED], speed[LISTED];
} Answer;

#endif
