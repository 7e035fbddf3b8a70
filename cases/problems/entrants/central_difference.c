/* Central differences with Newton's impact law at the ends of steps, contact by contact.

   cc -O2 -o central_difference central_difference.c -lm
   ./central_difference PROBLEM_DIRECTORY out.csv STEP      (a step in parts of the run)

   Velocities live between the steps. Contacts are held by their rates, so gaps overlap by part
   of a step; several contacts in one step are struck one after the other. First order. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading: enough of JSON for problem.json */

static char *text;

static char *read_all(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file) { fprintf(stderr, "cannot read %s\n", path); exit(2); }
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    char *all = calloc(size + 1, 1);
    if (fread(all, 1, size, file) != (size_t)size) exit(2);
    fclose(file);
    return all;
}
static char *value(const char *key) { /* where the value of a key begins */
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\":", key);
    return strstr(text, quoted) + strlen(quoted);
}
static double *numbers(const char *key, int *count) { /* of a list, nested ones in order */
    double *out = malloc(sizeof(double) * strlen(text));
    int depth = 0, n = 0;
    for (char *p = value(key);;) {
        if (*p == '[') depth++, p++;
        else if (*p == ']') { p++; if (--depth == 0) break; }
        else if (strchr("-0123456789", *p)) out[n++] = strtod(p, &p);
        else p++;
    }
    if (count) *count = n;
    return out;
}
static char **words(const char *key, int *count) {
    char **out = malloc(sizeof(char *) * 1000), *p = value(key);
    for (*count = 0; *p != ']' && *p != '\n'; p++)
        if (*p == '"') {
            char *end = strchr(p + 1, '"');
            out[(*count)++] = strndup(p + 1, end - p - 1);
            p = end;
        }
    return out;
}

static double *at, *a_g;
static int samples;

static double ground(double t) { /* times never go back */
    static int k = 0;
    while (k + 2 < samples && at[k + 1] <= t) k++;
    if (samples < 2 || t < at[0] || t >= at[samples - 1]) return 0;
    return a_g[k] + (a_g[k + 1] - a_g[k]) * (t - at[k]) / (at[k + 1] - at[k]);
}

int main(int argc, char **argv) {
    if (argc != 4) { fprintf(stderr, "PROBLEM OUT STEP\n"); return 2; }
    char *motion = read_all(argv[1], "motion.csv"), *p = strchr(motion, '\n') + 1;
    at = malloc(sizeof(double) * strlen(motion)), a_g = malloc(sizeof(double) * strlen(motion));
    for (; *p; p++, samples++) at[samples] = strtod(p, &p), a_g[samples] = strtod(p + 1, &p);
    text = read_all(argv[1], "problem.json");
    int N, S, K, one;
    char **name = words("problem", &one), **body = words("bodies", &N);
    char **contact = words("contacts", &K), **spring = words("names", &S);
    double *M = numbers("M", 0), *C = numbers("C", 0), *B = numbers("B", 0), *W = numbers("W", 0);
    double *kc = numbers("compression", 0), *ke = numbers("extension", 0);
    double *offset = numbers("offset", 0), *Q = numbers("strength", 0);
    double *uy = numbers("yield_displacement", 0), *power = numbers("n", 0);
    double *beta = numbers("beta", 0), *gam = numbers("gamma", 0), *z = numbers("z0", 0);
    double *gap = numbers("gaps", 0), *eps = numbers("restitutions", 0);
    double *u = numbers("u", 0), *v = numbers("v", 0), *f = calloc(N, sizeof *f);
    double start = strtod(value("start"), 0), end = strtod(value("end"), 0);
    long steps = 40 * ceil(1 / atof(argv[3]) / 40 - 1e-9); /* so that every moment is a step */
    long stride = steps / 40 % 25 ? 1 : steps / 1000;
    double h = (end - start) / steps, *w = malloc(sizeof *w * N);

    char path[4096];
    FILE *out = fopen(argv[2], "w");
    snprintf(path, sizeof path, "%.*s.events.csv", (int)strlen(argv[2]) - 4, argv[2]);
    FILE *events = fopen(path, "w");
    if (!out || !events) { fprintf(stderr, "cannot write %s\n", argv[2]); return 2; }
    fprintf(out, "# problem %s\nt", name[0]);
    for (int i = 0; i < N; i++) fprintf(out, ",u.%s,v.%s", body[i], body[i]);
    for (int s = 0; s < S; s++) if (Q[s]) fprintf(out, ",z.%s", spring[s]);
    fprintf(events, "t,contact,gap_velocity_before\n");

    for (long step = 0;; step++) {
        double t = step < steps ? start + step * h : end;
        /* forces: springs, dashpots, ground */
        for (int i = 0; i < N; i++) {
            f[i] = -M[i] * ground(t);
            for (int j = 0; j < N; j++) f[i] -= C[i * N + j] * v[j];
        }
        for (int s = 0; s < S; s++) {
            double x = -offset[s];
            for (int i = 0; i < N; i++) x += B[i * S + s] * u[i];
            double force = (x < 0 ? kc[s] : ke[s]) * x + Q[s] * z[s];
            for (int i = 0; i < N; i++) f[i] -= B[i * S + s] * force;
        }
        /* velocity in the middle of the next step; w at the step itself, for the output */
        double part = step == 0 || step == steps ? 0.5 : 1;
        for (int i = 0; i < N; i++) {
            w[i] = step ? v[i] + 0.5 * h * f[i] / M[i] : v[i];
            v[i] += part * h * f[i] / M[i];
        }
        /* impacts at closed contacts, until none approaches */
        int struck = 0, again = 1;
        for (int rounds = 0; again && rounds < 1000; rounds++) {
            again = 0;
            for (int c = 0; c < K; c++) {
                double g = gap[c], rate = 0, give = 0;
                for (int i = 0; i < N; i++) {
                    g += W[i * K + c] * u[i];
                    rate += W[i * K + c] * v[i];
                    give += W[i * K + c] * W[i * K + c] / M[i];
                }
                if (g > 0 || rate >= -1e-12) continue;
                again = struck = 1;
                fprintf(events, "%.17g,%s,%.17g\n", t, contact[c], rate);
                for (int i = 0; i < N; i++) {
                    v[i] -= (1 + eps[c]) * rate * W[i * K + c] / give / M[i];
                    w[i] = v[i];
                }
            }
        }
        if (struck || step % stride == 0) {
            fprintf(out, "\n%.17g", t);
            for (int i = 0; i < N; i++) fprintf(out, ",%.17g,%.17g", u[i], w[i]);
            for (int s = 0; s < S; s++) if (Q[s]) fprintf(out, ",%.17g", z[s]);
        }
        if (step == steps) break;
        /* hysteresis by the midpoint rule over the elongation of the step, then displacements */
        for (int s = 0; s < S; s++) {
            double x = 0, half = z[s], bound = pow(beta[s] + gam[s], -1 / power[s]);
            for (int i = 0; i < N; i++) x += B[i * S + s] * v[i] * h / uy[s];
            for (int stage = 2; stage; stage--) {
                double k = beta[s] + (x * half > 0 ? gam[s] : -gam[s]);
                half = z[s] + x * (1 - k * pow(fabs(half), power[s])) / stage;
                half = fmax(-bound, fmin(bound, half));
            }
            z[s] = half;
        }
        for (int i = 0; i < N; i++) u[i] += h * v[i];
    }
    fprintf(out, "\n");
    return fclose(out) || fclose(events);
}
