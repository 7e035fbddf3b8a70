// Bodies that collide on a line, solved in long double. Shares no code with the package.
//
//   oracle FILE      (the format: tests/oracle/scene_text.py; the words: read())
//
// Between events the motion is a Taylor series. Every series has its own state, gaps and gap
// rates too, which are set to zero exactly where they vanish, so that cascades keep their
// relative accuracy. Events are first roots of the series, isolated by the signs of their
// Bernstein coefficients. Impacts, and who rests, are complementarity problems, solved by
// trying every subset of contacts; who rests is decided by the first Taylor coefficient of
// a contact force or gap that does not vanish. Everything is done twice, with other orders and
// steps; what the two runs do not agree on is the uncertainty printed beside each number.
// Whatever cannot be decided is refused: "refused REASON", exit code 3.

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#if LDBL_MANT_DIG < 64
#error "long double is no more precise than double here"
#endif

typedef long double real;
using std::abs;
using std::max;
using std::min;
using std::string;
using std::vector;

const int MOST = 34;                // coefficients of a series
const real PI = acosl(-1.0L);
const real NOISE = 1e-16L;          // part of its terms below which a sum is their rounding
const real TOGETHER = 1e-14L;       // part of an interval within which two roots are one instant
const real LIMIT = 1e-22L;          // part of the fastest closing speed that ends a cascade
const real AT_BREAK = 1e-16L;       // part of a time by which a release may miss a break
const real SHORTEST = 1e-1000L;     // an interval below this is none: its impacts are plastic
const real HIGHER = 1e-15L;         // part of the largest displacement of the run by which a new extreme
                                    // must exceed: a body held at a barrier has one touch
typedef std::array<real, MOST + 1> Series;

struct Refusal { string why; };

// ---------------------------------------------------------------- the scene

struct Body { real mass, u, v; };
struct Elastic { int a, b; real compression, extension, offset; };
struct BoucWen {
    int a, b;
    real k, q, uy, n, beta, gamma, z, bound;
    bool whole;                                  // whole exponent: P by multiplications
    vector<std::pair<int, int>> products;        // of series 0 = |z|; the last one is P
};
struct Dashpot { int a, b; real c; };
struct Contact { int left, right; real gap, eps; bool closed; };
struct Term { real amplitude, omega, phase; };   // A cos(w s + p)

struct Motion {
    real start = -INFINITY, end = INFINITY;      // where it is not zero
    vector<Term> terms;
    bool wavelet = false;
    real center = 0, decay = 0, cubic[4] = {0, 0, 0, 0};
    vector<real> samples;
    real dt = 0;

    real sample_time(size_t i) const { return start + i * dt; }

    // The next moment after t at which the formula changes.
    real next_break(real t) const {
        if (t < start) return start;
        if (t >= end) return INFINITY;
        return samples.empty() ? end : sample_time(interval(t) + 1);
    }
    size_t interval(real t) const {
        size_t i = min((size_t)max(floorl((t - start) / dt), 0.0L), samples.size() - 2);
        while (i + 2 < samples.size() && t >= sample_time(i + 1)) ++i;
        while (i > 0 && t < sample_time(i)) --i;
        return i;
    }
    void series(real t, int order, Series& out) const {
        out.fill(0);
        if (t < start || t >= end) return;
        const real s = t - (std::isfinite(start) ? start : 0.0L);
        for (const Term& term : terms) {
            const real angle = term.omega * s + term.phase;
            real cosine = cosl(angle), sine = sinl(angle);
            const real rounding = 2e-19L * max(1.0L, abs(angle));
            if (abs(cosine) < rounding) cosine = 0;
            if (abs(sine) < rounding) sine = 0;
            const real turn[4] = {cosine, -sine, -cosine, sine};
            real factor = term.amplitude;
            for (int k = 0; k <= order; factor *= term.omega / ++k) out[k] += factor * turn[k % 4];
        }
        if (wavelet) {
            const real d = t - center;
            const real* c = cubic;
            const real shifted[4] = {c[0] + d * (c[1] + d * (c[2] + d * c[3])),
                                     c[1] + d * (2 * c[2] + 3 * d * c[3]), c[2] + 3 * d * c[3],
                                     c[3]};
            Series bell;
            bell[0] = expl(-decay * d * d);
            for (int k = 0; k < order; ++k)
                bell[k + 1] = -2 * decay * (d * bell[k] + (k ? bell[k - 1] : 0.0L)) / (k + 1);
            for (int k = 0; k <= order; ++k)
                for (int j = 0; j < 4 && j <= k; ++j) out[k] += shifted[j] * bell[k - j];
        }
        if (!samples.empty()) {
            const size_t i = interval(t);
            out[1] = (samples[i + 1] - samples[i]) / dt;
            out[0] = samples[i] + out[1] * (t - sample_time(i));
        }
    }
};

struct Scene {
    real start = 0, end = 0;
    vector<Body> bodies;
    vector<Elastic> elastic;
    vector<BoucWen> boucwen;
    vector<Dashpot> dashpots;
    vector<Contact> contacts;
    vector<real> moments;                            // at which displacements are wanted
    Motion motion;
};

// ---------------------------------------------------------------- reading

real number(std::istream& in) {
    string word;
    if (!(in >> word)) throw Refusal{"a number is missing"};
    char* rest;
    const real value = strtold(word.c_str(), &rest);
    if (*rest) throw Refusal{"not a number: " + word};
    return value;
}
int whole(std::istream& in) { return (int)number(in); }

// Laws in series share one force, so the kinks of all lie at force zero: one law again.
Elastic read_elastic(std::istream& in) {
    Elastic e{whole(in), whole(in), 0, 0, 0};
    real soft[2] = {0, 0};
    for (int parts = whole(in); parts > 0; --parts) {
        const real compression = number(in), extension = number(in);
        soft[0] += 1 / compression;
        soft[1] += 1 / extension;
        e.offset += number(in);
    }
    e.compression = 1 / soft[0];
    e.extension = 1 / soft[1];
    return e;
}

BoucWen read_boucwen(std::istream& in) {
    BoucWen s{};
    s.a = whole(in), s.b = whole(in);
    for (real* x : {&s.k, &s.q, &s.uy, &s.n, &s.beta, &s.gamma, &s.z}) *x = number(in);
    s.bound = powl(s.beta + s.gamma, -1 / s.n);
    s.whole = s.n == floorl(s.n) && s.n <= 1000;
    if (s.whole) {
        // |z|^n from the highest binary digit of n down: square, and multiply where it is 1.
        int last = 0, digits = 0;
        for (int n = (int)s.n; n >> digits; ) ++digits;
        for (int d = digits - 2; d >= 0; --d) {
            s.products.push_back({last, last});
            last = (int)s.products.size();
            if ((int)s.n >> d & 1) {
                s.products.push_back({last, 0});
                last = (int)s.products.size();
            }
        }
    }
    return s;
}

// Peak of |a| of a Mavroeidis-Papageorgiou pulse: bisection of its slope on a fine grid.
real largest_of(const vector<Term>& terms, real length) {
    auto value = [&](real x, bool slope) {
        real sum = 0;
        for (const Term& t : terms)
            sum += slope ? -t.amplitude * t.omega * sinl(t.omega * x + t.phase)
                         : t.amplitude * cosl(t.omega * x + t.phase);
        return sum;
    };
    real peak = 0;
    const int cells = 128 * (int)ceill(length / (2 * PI));
    for (int i = 0; i < cells; ++i) {
        real low = length * i / cells, high = length * (i + 1) / cells;
        if (value(low, true) * value(high, true) > 0) continue;
        for (int k = 0; k < 80; ++k) {
            const real middle = (low + high) / 2;
            (value(low, true) * value(middle, true) <= 0 ? high : low) = middle;
        }
        peak = max(peak, abs(value(low, false)));
    }
    return peak;
}

Motion read_motion(std::istream& in) {
    Motion m;
    string kind;
    in >> kind;
    if (kind == "none") {
        m.end = m.start;
    } else if (kind == "record") {
        m.start = number(in), m.dt = number(in);
        const real scale = number(in), over = number(in);
        for (int n = whole(in); n > 0; --n) m.samples.push_back(scale * number(in) / over);
        m.end = m.sample_time(m.samples.size() - 1);
    } else {
        const real ap = number(in), period = number(in), start = number(in);
        const real w = 2 * PI / period, first = number(in), second = number(in);
        m.start = start;
        m.end = start + period;
        if (kind == "sine" || kind == "harmonic") {
            m.terms = {{ap, w, -PI / 2}};
            if (kind == "harmonic") m.end = start + first * period;
        } else if (kind == "cosine") {
            m.terms = {{ap, w, 0}};
        } else if (kind == "type-c") {
            real phase = 0;
            for (int i = 0; i < 30; ++i) phase = atanl(2 / ((2 * first + 1) * PI - 2 * phase));
            m.terms = {{ap, w, phase}};
            m.end = start + (first + 0.5L - phase / PI) * period;
        } else if (kind == "mavroeidis-papageorgiou") {
            const real p = second + PI / 2 - PI * first, up = 1 + 1 / first, down = 1 - 1 / first;
            m.terms = {{0.5L, 1, p}, {-0.25L * up, up, p}, {-0.25L * down, down, p}};
            const real peak = largest_of(m.terms, 2 * PI * first);
            for (Term& t : m.terms) t.amplitude *= ap / peak, t.omega *= w;
            m.end = start + first * period;
        } else if (kind == "ricker" || kind == "antisymmetric-ricker") {
            m.wavelet = true;
            m.start = -INFINITY;
            m.end = INFINITY;
            m.center = first + second * period;
            if (kind == "ricker") {
                m.decay = (PI / period) * (PI / period);
                m.cubic[0] = ap, m.cubic[2] = -2 * m.decay * ap;
            } else {
                const real r = 3 - sqrtl(6.0L), width = sqrtl(3.0L) / w;
                const real a = ap / (sqrtl(6 * r) * expl(-r / 2));
                m.decay = 1 / (2 * width * width);
                m.cubic[1] = -3 * a / width, m.cubic[3] = a / (width * width * width);
            }
        } else throw Refusal{"a motion of the kind " + kind};
    }
    return m;
}

Scene read(std::istream& in) {
    Scene s;
    for (string word; in >> word; ) {
        if (word == "run") s.start = number(in), s.end = number(in);
        else if (word == "body") {
            const real m = number(in), u = number(in);
            s.bodies.push_back({m, u, number(in)});
        } else if (word == "elastic") s.elastic.push_back(read_elastic(in));
        else if (word == "boucwen") s.boucwen.push_back(read_boucwen(in));
        else if (word == "dashpot") {
            const int a = whole(in), b = whole(in);
            s.dashpots.push_back({a, b, number(in)});
        } else if (word == "contact") {
            const int a = whole(in), b = whole(in);
            const real gap = number(in), eps = number(in);
            s.contacts.push_back({a, b, gap, eps, whole(in) != 0});
        } else if (word == "moments") {
            for (int n = whole(in); n > 0; --n) s.moments.push_back(number(in));
        } else if (word == "motion") s.motion = read_motion(in);
        else throw Refusal{"the word " + word};
    }
    return s;
}

// ---------------------------------------------------------------- polynomials

real value_at(const Series& c, int order, real h) {
    real sum = c[order];
    for (int k = order; k-- > 0; ) sum = sum * h + c[k];
    return sum;
}

// Smallest root in (0, h] of a series whose leading zeros are exact; -1 where there is none.
// By the signs of Bernstein coefficients, halved until they change once or not at all.
struct Roots {
    int n;
    Series c;        // of x = t/h, leading zeros taken out
    mutable int looks = 0;

    // The first root in (0, end].
    real within(real end) const {
        vector<real> b(n + 1, 0.0L);
        for (int i = 0; i <= n; ++i) {
            real ratio = 1, p = 1;                     // C(i,k)/C(n,k), end^k
            for (int k = 0; k <= i; ratio *= (real)(i - k) / (n - k), p *= end, ++k) {
                b[i] += ratio * p * c[k];
                if (k == n) break;
            }
        }
        return find(b, 0, end, 0);
    }

    real find(const vector<real>& b, real low, real high, int depth) const {
        int changes = 0, sign = 0;
        for (real x : b) {
            const int now = (x > 0) - (x < 0);
            if (now && sign && now != sign) ++changes;
            if (now) sign = now;
        }
        if (changes == 0) return -1;
        if (changes == 1 && b.front() * b.back() <= 0) return refine(low, high, b.front());
        if (depth > 70 || ++looks > 3000) throw Refusal{"a root that is double to rounding"};
        vector<real> left(n + 1), right(b);
        for (int i = 0; i <= n; ++i) {
            left[i] = right[0];
            for (int j = 0; j < n - i; ++j) right[j] = (right[j] + right[j + 1]) / 2;
        }
        // De Casteljau leaves the right half reversed order by order.
        vector<real> work(b), last(n + 1);
        for (int i = 0; i <= n; ++i) {
            last[n - i] = work[n - i];
            for (int j = 0; j < n - i; ++j) work[j] = (work[j] + work[j + 1]) / 2;
            last[n - i] = work[n - i];
        }
        const real middle = (low + high) / 2, root = find(left, low, middle, depth + 1);
        return root >= 0 ? root : find(last, middle, high, depth + 1);
    }
    real refine(real low, real high, real before) const {
        real f_low = before;
        for (int i = 0; i < 200 && high - low > 1e-20L * high; ++i) {
            real middle = (low + high) / 2, slope = 0, f = value_at(c, n, middle);
            if ((f > 0) == (f_low > 0) && f != 0) low = middle; else high = middle;
            // A step of Newton narrows the bracket from both sides of where it lands.
            for (int k = n; k > 0; --k) slope = slope * middle + k * c[k];
            const real step = slope != 0 ? f / slope : 0, guess = middle - step;
            const real width = max(abs(step) * abs(step) / max(high, 1e-300L), 1e-19L * high);
            for (real x : {guess - width, guess + width})
                if (x > low && x < high) {
                    f = value_at(c, n, x);
                    if ((f > 0) == (f_low > 0) && f != 0) low = x; else high = x;
                }
        }
        return (low + high) / 2;
    }
};

real first_root(const Series& series, int order, real h) {
    int zeros = 0;
    while (zeros <= order && series[zeros] == 0) ++zeros;
    if (zeros >= order) return -1;
    Roots r;
    r.n = order - zeros;
    real power = 1;
    real rest = 0;
    for (int k = 0; k <= r.n; ++k, power *= h) {
        r.c[k] = series[k + zeros] * power;
        if (k) rest += abs(r.c[k]);
    }
    if (rest < abs(r.c[0])) return -1;
    // No root where the other terms together are below the first: windows grow from there, so
    // that a root that is 1e-60 of the step is found as surely as one in its middle.
    real from = 1;
    for (; from > 1e-4000L; from /= 2) {
        real sum = 0, p = from;
        for (int k = 1; k <= r.n; ++k, p *= from) sum += abs(r.c[k]) * p;
        if (sum < abs(r.c[0])) break;
    }
    for (real end = min(8 * from, 1.0L); ; end = min(8 * end, 1.0L)) {
        const real root = r.within(end);
        if (root > 0) return root * h;
        if (end == 1) return -1;
    }
}

// x of A x = b, false where A is singular to rounding.
bool solve(vector<vector<real>> A, vector<real> b, vector<real>& x) {
    const int n = (int)b.size();
    for (int i = 0; i < n; ++i) {
        int p = i;
        for (int r = i; r < n; ++r) if (abs(A[r][i]) > abs(A[p][i])) p = r;
        std::swap(A[i], A[p]), std::swap(b[i], b[p]);
        real size = 0;
        for (int r = 0; r < n; ++r) size = max(size, abs(A[r][i]));
        if (abs(A[i][i]) <= 1e-15L * size || A[i][i] == 0) return false;
        for (int r = i + 1; r < n; ++r) {
            const real f = A[r][i] / A[i][i];
            for (int c = i; c < n; ++c) A[r][c] -= f * A[i][c];
            b[r] -= f * b[i];
        }
    }
    x.assign(n, 0);
    for (int i = n; i-- > 0; ) {
        real s = b[i];
        for (int c = i + 1; c < n; ++c) s -= A[i][c] * x[c];
        x[i] = s / A[i][i];
    }
    return true;
}

// ---------------------------------------------------------------- results

struct Event { string kind; int contact; real t, before, after, impulse, loudest = 0; };
struct Extreme { real value, t; };
struct Result {
    vector<vector<Extreme>> highest, lowest;        // of each body, one beyond the other
    vector<real> u, v, z;
    vector<vector<real>> moments;                   // displacements at each moment wanted
    vector<Event> events;
    long steps = 0;
};

// ---------------------------------------------------------------- one run

class Run {
    const Scene& s;
    const int N, C, E, B, K;
    const real tol;
    real t;
    vector<real> u, v, z, g, rate;                  // g and rate of every contact
    vector<char> rests;                             // contact
    vector<int> cluster;                            // of each body; -1 held by a barrier
    vector<int> sx, branch;                         // sign of x' of hysteretic, of x - o of elastic
    vector<char> turned, kinked;                    // x' or x - o is zero at this moment
    vector<real> v_most, z_most;
    real fastest = 0, largest = 0;                  // closing speed, displacement so far
    real span;                                      // length of the last step
    // series of the present step
    vector<Series> U, V, Z, G, R, L, X, Y;          // R rates of gaps, L forces, X x', Y x - o
    vector<Series> size;                            // of the terms of each body's force
    vector<vector<Series>> power;
    Series ground;
    Result out;

    static real at(const vector<real>& x, int i) { return i < 0 ? 0.0L : x[i]; }
    static real at(const vector<Series>& x, int i, int k) { return i < 0 ? 0.0L : x[i][k]; }

public:
    Run(const Scene& scene, int order, real tolerance)
        : s(scene), N((int)s.bodies.size()), C((int)s.contacts.size()), E((int)s.elastic.size()),
          B((int)s.boucwen.size()), K(order), tol(tolerance), t(s.start), g(C), rate(C),
          rests(C, 0), cluster(N), sx(B, 1), branch(E, 1), turned(B, 0), kinked(E, 0),
          v_most(N, 0), z_most(B, 0), span(1e-3L * (s.end - s.start)), U(N), V(N), Z(B), G(C),
          R(C), L(C), X(B), Y(E), size(N), power(B) {
        for (const Body& b : s.bodies) u.push_back(b.u), v.push_back(b.v);
        for (int i = 0; i < B; ++i) {
            z.push_back(s.boucwen[i].z);
            power[i].resize(s.boucwen[i].products.size() + 1);
        }
        for (int j = 0; j < C; ++j) {
            const Contact& c = s.contacts[j];
            g[j] = c.closed ? 0.0L : c.gap + at(u, c.right) - at(u, c.left);
            rate[j] = at(v, c.right) - at(v, c.left);
        }
        for (int i = 0; i < N; ++i) {
            out.highest.push_back({{u[i], t}});
            out.lowest.push_back({{u[i], t}});
            largest = max(largest, abs(u[i]));
        }
    }

    Result go() {
        bool closing = false;
        for (int j = 0; j < C; ++j) closing |= g[j] == 0 && rate[j] < 0;
        if (closing) impact(false);
        settle();
        at_moments(0);
        while (t < s.end) step();
        out.u = u, out.v = v, out.z = z;
        for (int i = 0; i < N; ++i) {
            extreme(i, u[i], t);
            keep_what_counts(out.highest[i]);
            keep_what_counts(out.lowest[i]);
        }
        return out;
    }

private:
    // ------------------------------------------------ series

    // Bodies that rest on each other move as one; false for a row between two barriers.
    bool find_clusters(const vector<char>& resting) {
        vector<int> root(N + 1);
        for (int i = 0; i <= N; ++i) root[i] = i;
        bool tree = true;
        for (int j = 0; j < C; ++j) {
            if (!resting[j]) continue;
            const Contact& c = s.contacts[j];
            const int a = root[c.left < 0 ? N : c.left], b = root[c.right < 0 ? N : c.right];
            if (a == b) tree = false;
            for (int& r : root) if (r == a) r = b;
        }
        for (int i = 0; i < N; ++i) cluster[i] = root[i] == root[N] ? -1 : root[i];
        return tree;
    }

    // The sum over a body's cluster, by the mass of the cluster; zero where a barrier holds it.
    vector<real> of_clusters(const vector<real>& x) const {
        vector<real> total(N, 0.0L), mass(N, 0.0L), each(N, 0.0L);
        for (int i = 0; i < N; ++i) {
            if (cluster[i] < 0) continue;
            total[cluster[i]] += x[i];
            mass[cluster[i]] += s.bodies[i].mass;
        }
        for (int i = 0; i < N; ++i)
            if (cluster[i] >= 0) each[i] = total[cluster[i]] / mass[cluster[i]];
        return each;
    }

    // All series for given resting contacts and signs.
    void expand(const vector<char>& resting) {
        vector<int> members;
        for (int j = 0; j < C; ++j) if (resting[j]) members.push_back(j);
        const vector<vector<real>> delassus = coupling(members);
        s.motion.series(t, K, ground);
        for (int i = 0; i < N; ++i) U[i][0] = u[i], V[i][0] = v[i];
        for (int j = 0; j < C; ++j) G[j][0] = g[j], R[j][0] = rate[j];
        for (int i = 0; i < B; ++i) Z[i][0] = z[i];
        vector<real> f(N), a(N), x;
        for (int k = 0; k < K; ++k) {
            forces(k, f);
            a = of_clusters(f);
            for (int i = 0; i < N; ++i) {
                V[i][k + 1] = a[i] / (k + 1);
                U[i][k + 1] = V[i][k] / (k + 1);
            }
            for (int j = 0; j < C; ++j) {
                const Contact& c = s.contacts[j];
                R[j][k + 1] = (at(a, c.right) - at(a, c.left)) / (k + 1);
                G[j][k + 1] = R[j][k] / (k + 1);
                L[j][k] = 0;
            }
            if (members.empty()) continue;
            vector<real> q;
            for (int j : members) q.push_back(-free_rate(j, f));
            if (!solve(delassus, q, x)) throw Refusal{"a row locked between two barriers"};
            for (size_t i = 0; i < members.size(); ++i) L[members[i]][k] = x[i];
        }
    }

    real free_rate(int j, const vector<real>& f) const {
        const Contact& c = s.contacts[j];
        return (c.right < 0 ? 0.0L : f[c.right] / s.bodies[c.right].mass) -
               (c.left < 0 ? 0.0L : f[c.left] / s.bodies[c.left].mass);
    }

    // W' M^-1 W over some contacts.
    vector<vector<real>> coupling(const vector<int>& of) const {
        vector<vector<real>> A(of.size(), vector<real>(of.size(), 0.0L));
        for (size_t i = 0; i < of.size(); ++i)
            for (size_t j = 0; j < of.size(); ++j) {
                const Contact &p = s.contacts[of[i]], &q = s.contacts[of[j]];
                for (int b = 0; b < N; ++b) {
                    const int wp = (p.right == b) - (p.left == b);
                    const int wq = (q.right == b) - (q.left == b);
                    A[i][j] += wp * wq / s.bodies[b].mass;
                }
            }
        return A;
    }

    // Coefficient k of the forces on all bodies but those of contacts, and of all elongations.
    void forces(int k, vector<real>& f) {
        for (int i = 0; i < N; ++i) {
            f[i] = -s.bodies[i].mass * ground[k];
            size[i][k] = abs(f[i]);
        }
        auto pull = [&](int a, int b, real force) {
            if (a >= 0) f[a] += force, size[a][k] += abs(force);
            if (b >= 0) f[b] -= force, size[b][k] += abs(force);
        };
        for (int e = 0; e < E; ++e) {
            const Elastic& p = s.elastic[e];
            Y[e][k] = at(U, p.b, k) - at(U, p.a, k) - (k == 0 ? p.offset : 0.0L);
            if (k == 0 && kinked[e]) Y[e][k] = 0;
            pull(p.a, p.b, (branch[e] > 0 ? p.extension : p.compression) * Y[e][k]);
        }
        for (int i = 0; i < B; ++i) {
            const BoucWen& p = s.boucwen[i];
            X[i][k] = at(V, p.b, k) - at(V, p.a, k);
            pull(p.a, p.b, p.k * (at(U, p.b, k) - at(U, p.a, k)) + p.q * Z[i][k]);
            hysteresis(i, k);
        }
        for (const Dashpot& d : s.dashpots) pull(d.a, d.b, d.c * (at(V, d.b, k) - at(V, d.a, k)));
    }

    int sign_of_z(int i) const { return z[i] > 0 ? 1 : z[i] < 0 ? -1 : sx[i]; }
    bool too_small(const BoucWen& p, real w) const {
        return !p.whole && powl(w, p.n) < 0.01L * tol;
    }

    // z_{k+1} from z' = x'/uy (1 - kappa |z|^n).
    void hysteresis(int i, int k) {
        const BoucWen& p = s.boucwen[i];
        const int sz = sign_of_z(i);
        vector<Series>& w = power[i];
        Series* P = &w.back();
        if (p.whole) {
            w[0][k] = sz * Z[i][k];
            for (size_t m = 0; m < p.products.size(); ++m) {
                const Series &a = w[p.products[m].first], &b = w[p.products[m].second];
                real sum = 0;
                for (int j = 0; j <= k; ++j) sum += a[j] * b[k - j];
                w[m + 1][k] = sum;
            }
        } else if (too_small(p, abs(z[i]))) {
            (*P)[k] = 0;
        } else if (k == 0) {
            (*P)[0] = powl(abs(z[i]), p.n);
        } else {
            real sum = 0;
            for (int j = 1; j <= k; ++j) sum += (p.n * j - (k - j)) * sz * Z[i][j] * (*P)[k - j];
            (*P)[k] = sum / (k * abs(z[i]));
        }
        const real kappa = p.beta + p.gamma * sx[i] * sz;
        real sum = X[i][k];
        for (int j = 0; j <= k; ++j) sum -= kappa * X[i][j] * (*P)[k - j];
        Z[i][k + 1] = sum / p.uy / (k + 1);
    }

    // Sign of the first coefficient that is more than the rounding of its terms; those before
    // are set to zero. 0 where there is none.
    template <class Size> int leading(Series& c, int from, int order, Size terms) {
        for (int k = from; k <= order; ++k) {
            if (abs(c[k]) > NOISE * terms(k)) return c[k] > 0 ? 1 : -1;
            c[k] = 0;
        }
        return 0;
    }

    // Size of the terms that coefficient k of a body's velocity is the sum of.
    real speed_terms(int i, int k) const {
        if (i < 0) return 0;
        return k == 0 ? abs(V[i][0]) : 10 * force_terms(i, k - 1) / s.bodies[i].mass / k;
    }
    // Of the force: where all of its terms pass zero together their course through a step counts.
    real force_terms(int i, int k) const {
        real most = size[i][k];
        for (int j = 0; j < 6; ++j) most = max(most, size[i][j] * powl(span, j - k));
        return most;
    }

    // Series with signs that agree with the motion they make; false where none are found.
    bool expand_with_signs(const vector<char>& resting) {
        for (int tries = 0; tries < 2 * (B + E) + 4; ++tries) {
            expand(resting);
            bool same = true;
            for (int i = 0; i < B; ++i) {
                const BoucWen& p = s.boucwen[i];
                if (turned[i]) X[i][0] = 0;
                const int now = leading(X[i], 0, K - 1, [&](int k) {
                    return speed_terms(p.a, k) + speed_terms(p.b, k); });
                if (now && now != sx[i]) sx[i] = now, same = false;
            }
            for (int e = 0; e < E; ++e) {
                const Elastic& p = s.elastic[e];
                if (p.compression == p.extension) continue;
                const int now = leading(Y[e], 0, K - 1, [&](int k) {
                    if (k) return (speed_terms(p.a, k - 1) + speed_terms(p.b, k - 1)) / k;
                    return abs(at(U, p.a, 0)) + abs(at(U, p.b, 0)) + abs(p.offset); });
                if (now && now != branch[e]) branch[e] = now, same = false;
            }
            if (same) return true;
        }
        return false;
    }

    // ------------------------------------------------ who rests

    // Whether forces of the resting contacts press and the other closed ones open.
    bool consistent(const vector<char>& resting, const vector<int>& closed) {
        for (int j : closed) {
            const Contact& c = s.contacts[j];
            if (resting[j]) {
                const int now = leading(L[j], 0, K / 2, [&](int k) {
                    real most = 0;
                    for (int i = 0; i < N; ++i)
                        if (c.left == i || c.right == i ||
                            (c.left >= 0 && cluster[i] == cluster[c.left]) ||
                            (c.right >= 0 && cluster[i] == cluster[c.right]))
                            most += force_terms(i, k);
                    return 10 * most; });
                if (now < 0) return false;
            } else {
                const int now = leading(R[j], 1, K / 2, [&](int k) {
                    return speed_terms(c.left, k) + speed_terms(c.right, k); });
                if (now <= 0) return false;
                for (int k = 1; k <= K; ++k) G[j][k] = R[j][k - 1] / k;
            }
        }
        return true;
    }

    // Bodies that closed contacts join to a barrier are where its place and the gaps say, exactly:
    // a spring that is unstrained there pulls by nothing, and not by the rounding of a place.
    void onto_barriers(const vector<int>& closed) {
        vector<char> known(N, 0);
        for (size_t pass = 0; pass < closed.size(); ++pass)
            for (int j : closed) {
                const Contact& c = s.contacts[j];
                const bool left = c.left < 0 || known[c.left], right = c.right < 0 || known[c.right];
                if (left == right) continue;
                const int known_one = left ? c.left : c.right, other = left ? c.right : c.left;
                const real place = known_one < 0 ? 0 : u[known_one];
                u[other] = left ? place - c.gap : place + c.gap;
                known[other] = 1;
            }
    }

    void settle() {
        vector<int> closed;
        for (int j = 0; j < C; ++j) if (g[j] == 0 && rate[j] == 0) closed.push_back(j);
        if (closed.size() > 12) throw Refusal{"more than 12 closed contacts"};
        onto_barriers(closed);
        const vector<char> before = rests;
        bool locked = false;
        auto holds = [&](const vector<char>& trial) {
            if (!find_clusters(trial)) return locked = true, false;
            return expand_with_signs(trial) && consistent(trial, closed);
        };
        vector<char> trial(C, 0);
        for (int j : closed) trial[j] = before[j];
        bool found = holds(trial);
        for (long set = (1L << closed.size()) - 1; set >= 0 && !found; --set) {
            for (size_t i = 0; i < closed.size(); ++i) trial[closed[i]] = set >> i & 1;
            found = holds(trial);
        }
        if (!found && locked) throw Refusal{"a row locked between two barriers"};
        if (!found) throw Refusal{"nobody knows who rests"};
        rests = trial;
        for (int j = 0; j < C; ++j) {
            if (rests[j] && !before[j]) out.events.push_back({"rest", j, t, 0, 0, 0});
            if (before[j] && !rests[j] && rate[j] == 0)
                out.events.push_back({"detachment", j, t, 0, 0, 0});
        }
        vector<real> momentum(N);
        for (int i = 0; i < N; ++i) momentum[i] = s.bodies[i].mass * v[i];
        v = of_clusters(momentum);
    }

    // ------------------------------------------------ impacts

    void impact(bool plastic) {
        bool ends = false;
        for (int again = 0; ; ++again) {
            if (again > 1000) throw Refusal{"impacts of one instant without end"};
            vector<int> of;
            real most = 0;
            for (int j = 0; j < C; ++j)
                if (g[j] == 0 && rate[j] <= 0) of.push_back(j), most = max(most, -rate[j]);
            if (most == 0) break;
            fastest = max(fastest, most);
            ends |= most < LIMIT * fastest;
            strike(of, plastic || ends);
        }
        for (int j = 0; j < C; ++j) {
            if (ends && g[j] == 0 && rate[j] == 0 && !rests[j])
                out.events.push_back({"accumulation", j, t, 0, 0, 0});
            if (rests[j] && rate[j] > 0) out.events.push_back({"separation", j, t, 0, rate[j], 0});
            if (rate[j] != 0) rests[j] = 0;
        }
        if (out.events.size() > 20000) throw Refusal{"more than 20000 events"};
    }

    // 0 <= G x + (1 + eps) rate, perpendicular to x >= 0, by trying every set of x > 0.
    void strike(const vector<int>& of, bool plastic) {
        const int m = (int)of.size();
        if (m > 12) throw Refusal{"more than 12 contacts in one impact"};
        const vector<vector<real>> A = coupling(of);
        vector<real> q(m), x(m), w(m);
        real most = 0;
        auto eps = [&](int i) { return plastic ? 0.0L : s.contacts[of[i]].eps; };
        for (int i = 0; i < m; ++i) q[i] = (1 + eps(i)) * rate[of[i]], most = max(most, -q[i]);
        vector<char> active(m);
        bool found = false;
        for (long set = 1; set < 1L << m && !found; ++set) {
            vector<int> in;
            for (int i = 0; i < m; ++i) if ((active[i] = (char)(set >> i & 1))) in.push_back(i);
            vector<vector<real>> part(in.size(), vector<real>(in.size()));
            vector<real> b(in.size()), y;
            for (size_t i = 0; i < in.size(); ++i) {
                b[i] = -q[in[i]];
                for (size_t k = 0; k < in.size(); ++k) part[i][k] = A[in[i]][in[k]];
            }
            if (!solve(part, b, y)) continue;
            found = true;
            x.assign(m, 0);
            for (size_t i = 0; i < in.size(); ++i) {
                x[in[i]] = y[i];
                found &= y[i] * A[in[i]][in[i]] >= -NOISE * most;
            }
            for (int i = 0; i < m; ++i) {
                w[i] = q[i];
                for (int k = 0; k < m; ++k) w[i] += A[i][k] * x[k];
                found &= active[i] || w[i] >= -NOISE * most;
            }
        }
        if (!found) throw Refusal{"an impact without solution"};
        vector<real> change(N, 0.0L);
        for (int i = 0; i < m; ++i) {
            const Contact& c = s.contacts[of[i]];
            if (c.left >= 0) change[c.left] -= x[i] / s.bodies[c.left].mass;
            if (c.right >= 0) change[c.right] += x[i] / s.bodies[c.right].mass;
        }
        const vector<real> before = rate;
        real loudest = 0;
        for (int j : of) loudest = max(loudest, -before[j]);
        for (int i = 0; i < N; ++i) v[i] += change[i];
        for (int j = 0; j < C; ++j) {
            const Contact& c = s.contacts[j];
            rate[j] += at(change, c.right) - at(change, c.left);
            const real terms = abs(before[j]) + abs(at(change, c.right)) + abs(at(change, c.left));
            if (g[j] == 0 && abs(rate[j]) <= NOISE * terms) rate[j] = 0;
        }
        for (int i = 0; i < m; ++i) {
            const int j = of[i];
            if (active[i]) rate[j] = -eps(i) * before[j];
            if (before[j] < 0 || x[i] > 0)
                out.events.push_back({"impact", j, t, before[j], rate[j], x[i], loudest});
        }
    }

    // ------------------------------------------------ steps

    enum Kind { CLOSING, RELEASE, REVERSAL, KINK, ZERO };
    struct Root { Kind kind; int index; real tau; };

    real step_size(real h) {
        auto fits = [&](real h) {
            auto tail = [&](const Series& c, real most, real floor) {
                real p = 1, own = most, last = 0;
                for (int k = 0; k < K; ++k, p *= h) own = max(own, last = abs(c[k]) * p);
                const real before = abs(c[K - 2]) * p / (h * h);
                return max(last, before) <= tol * max(own, floor);
            };
            real all = 0;
            for (int i = 0; i < N; ++i) all = max(all, v_most[i]);
            for (int i = 0; i < N; ++i) if (!tail(V[i], v_most[i], 1e-8L * all)) return false;
            for (int i = 0; i < B; ++i) if (!tail(Z[i], z_most[i], 0)) return false;
            return true;
        };
        for (int i = 0; i < 4000 && !fits(h); ++i) h *= 0.8L;
        return h;
    }

    // Whether z at tau obeys its equation there: |z|^20 hides what is to come from all
    // coefficients.
    bool obeys(real tau) {
        for (int i = 0; i < B; ++i) {
            const BoucWen& p = s.boucwen[i];
            real slope = 0;
            for (int k = K; k > 0; --k) slope = slope * tau + k * Z[i][k];
            const int sz = sign_of_z(i);
            const real w = max(sz * value_at(Z[i], K, tau), 0.0L), x = value_at(X[i], K - 1, tau);
            const real true_slope = x / p.uy * (1 - (p.beta + p.gamma * sx[i] * sz) * powl(w, p.n));
            const real rounding = 1e-18L * p.n * abs(x) / p.uy * tau;
            const real allowed = 100 * tol * max(z_most[i], 1e-6L * p.bound) + rounding;
            if (!(abs(slope - true_slope) * tau <= allowed)) return false;
        }
        return true;
    }

    vector<Root> roots(real h) {
        vector<Root> found;
        auto look = [&](Kind kind, int i, const Series& c, int order) {
            const real root = first_root(c, order, h);
            if (root > 0) found.push_back({kind, i, root});
        };
        for (int j = 0; j < C; ++j)
            rests[j] ? look(RELEASE, j, L[j], K - 1) : look(CLOSING, j, G[j], K);
        for (int i = 0; i < B; ++i) look(REVERSAL, i, X[i], K - 1), look(ZERO, i, Z[i], K);
        for (int e = 0; e < E; ++e)
            if (s.elastic[e].compression != s.elastic[e].extension) look(KINK, e, Y[e], K - 1);
        return found;
    }

    // A force that vanishes just as the ground's motion changes its law is zero there, and what
    // follows is told by the new law; by the old one rounding would say that it pulls.
    void leave_to_break(vector<Root>& all, real stop) const {
        auto at_break = [&](const Root& r) {
            return r.kind == RELEASE && stop - (t + r.tau) <= AT_BREAK * stop;
        };
        all.erase(std::remove_if(all.begin(), all.end(), at_break), all.end());
    }

    void step() {
        if (++out.steps > 3000000) throw Refusal{"more than 3000000 steps"};
        find_clusters(rests);
        if (!expand_with_signs(rests)) throw Refusal{"a motion without a side of a kink"};
        vector<int> closed;
        for (int j = 0; j < C; ++j) if (g[j] == 0 && rate[j] == 0) closed.push_back(j);
        // A release at the very end of a step may be in neither by the signs of its force.
        if (!consistent(rests, closed)) settle();
        const real stop = min(s.end, s.motion.next_break(t));
        real h = step_size(stop - t), tau = h;
        span = h;
        vector<Root> all, now;
        for (int tries = 0; ; ++tries) {
            if (tries > 200) throw Refusal{"no step is short enough"};
            all = roots(h);
            if (h == stop - t) leave_to_break(all, stop);
            tau = h;
            for (const Root& r : all) tau = min(tau, r.tau);
            if (obeys(tau) && obeys(tau / 2)) break;
            h = tau / 2;
        }
        for (const Root& r : all) if (r.tau <= tau * (1 + TOGETHER)) now.push_back(r);
        turning_points(tau);
        at_moments(tau);
        advance(tau);
        t = now.empty() && h == stop - t ? stop : t + tau;
        // A turn at the very end, as at a reversal, may be in neither step by its signs.
        for (int i = 0; i < N; ++i) if (abs(v[i]) <= 1e-17L * v_most[i]) extreme(i, u[i], t);
        happen(now, tau);
        if (t == stop) settle();
    }

    // Displacements at the moments that come until tau; those of the start before any step.
    void at_moments(real tau) {
        while (out.moments.size() < s.moments.size() &&
               s.moments[out.moments.size()] <= t + tau) {
            const real since = s.moments[out.moments.size()] - t;
            vector<real> x(u);
            if (tau > 0) for (int i = 0; i < N; ++i) x[i] = value_at(U[i], K, since);
            out.moments.push_back(x);
        }
    }

    void advance(real tau) {
        for (int i = 0; i < N; ++i) {
            u[i] = value_at(U[i], K, tau), v[i] = value_at(V[i], K, tau);
            v_most[i] = max(v_most[i], abs(v[i]));
            largest = max(largest, abs(u[i]));
        }
        for (int i = 0; i < B; ++i) {
            z[i] = value_at(Z[i], K, tau);
            z_most[i] = max(z_most[i], abs(z[i]));
        }
        for (int j = 0; j < C; ++j) {
            if (rests[j]) continue;
            g[j] = value_at(G[j], K, tau), rate[j] = value_at(R[j], K, tau);
        }
        std::fill(turned.begin(), turned.end(), 0);
        std::fill(kinked.begin(), kinked.end(), 0);
    }

    void happen(const vector<Root>& now, real tau) {
        bool closing = false, release = false;
        for (const Root& r : now) {
            if (r.kind == REVERSAL) turned[r.index] = 1, sx[r.index] = -sx[r.index];
            if (r.kind == KINK) kinked[r.index] = 1, branch[r.index] = -branch[r.index];
            if (r.kind == ZERO) z[r.index] = 0;
            if (r.kind == RELEASE) release = true;
            if (r.kind != CLOSING) continue;
            closing = true;
            g[r.index] = 0;
            real terms = 0, p = 1;
            for (int k = 0; k <= K; ++k, p *= tau) terms += abs(R[r.index][k]) * p;
            if (rate[r.index] > -1e-12L * terms) throw Refusal{"a graze"};
        }
        if (closing) {
            for (int i = 0; i < N; ++i) extreme(i, u[i], t);
            impact(tau < SHORTEST);
        }
        if (closing || release) settle();
    }

    // ------------------------------------------------ extremes

    void extreme(int i, real value, real when) {
        if (value > out.highest[i].back().value) out.highest[i].push_back({value, when});
        if (value < out.lowest[i].back().value) out.lowest[i].push_back({value, when});
    }

    // Leave the last of those that exceed the one before by more than rounding.
    void keep_what_counts(vector<Extreme>& extremes) const {
        Extreme last = extremes.front();
        for (const Extreme& e : extremes)
            if (abs(e.value - last.value) > HIGHER * largest) last = e;
        extremes = {last};
    }

    // Every root of v in the step, where u could leave what it has reached so far.
    void turning_points(real tau) {
        for (int i = 0; i < N; ++i) {
            real reach = 0, p = tau;
            for (int k = 1; k <= K; ++k, p *= tau) reach += abs(U[i][k]) * p;
            const bool higher = u[i] + reach > out.highest[i].back().value;
            if (!higher && u[i] - reach >= out.lowest[i].back().value) continue;
            Series c = V[i];
            real from = 0;
            while (from < tau) {
                const real root = first_root(c, K, tau - from);
                if (root <= 0) break;
                from += root;
                extreme(i, value_at(U[i], K, from), t + from);
                // The series about the root, whose own value is zero there.
                for (int j = 0; j < K; ++j)
                    for (int k = K - 1; k >= j; --k) c[k] += root * c[k + 1];
                c[0] = 0;
            }
        }
    }
};

// ---------------------------------------------------------------- two runs and their difference

vector<Event> loud_ones(const Result& r) {
    real most = 0;
    for (const Event& e : r.events) most = max(most, -e.before);
    vector<Event> kept;
    for (const Event& e : r.events)
        if (e.kind != "impact" || e.loudest > 1e-9L * most) kept.push_back(e);
    return kept;
}

void print(const char* name, real a, real b) { printf(" %s %.21Lg %.2Lg", name, a, abs(a - b)); }

void report(const Result& a, const Result& b) {
    for (size_t i = 0; i < a.u.size(); ++i) {
        printf("body %zu", i);
        print("max", a.highest[i].back().value, b.highest[i].back().value);
        print("t_max", a.highest[i].back().t, b.highest[i].back().t);
        print("min", a.lowest[i].back().value, b.lowest[i].back().value);
        print("t_min", a.lowest[i].back().t, b.lowest[i].back().t);
        print("u", a.u[i], b.u[i]);
        print("v", a.v[i], b.v[i]);
        printf("\n");
    }
    for (size_t k = 0; k < a.moments.size() && k < b.moments.size(); ++k)
        for (size_t i = 0; i < a.u.size(); ++i) {
            printf("moment %zu %zu", k, i);
            print("u", a.moments[k][i], b.moments[k][i]);
            printf("\n");
        }
    for (size_t i = 0; i < a.z.size(); ++i) {
        printf("spring %zu", i);
        print("z", a.z[i], b.z[i]);
        printf("\n");
    }
    const vector<Event> p = loud_ones(a), q = loud_ones(b);
    if (p.size() != q.size()) throw Refusal{"two settings find other events"};
    for (size_t i = 0; i < p.size(); ++i) {
        if (p[i].kind != q[i].kind || p[i].contact != q[i].contact)
            throw Refusal{"two settings find other events"};
        printf("event %s %d", p[i].kind.c_str(), p[i].contact);
        print("t", p[i].t, q[i].t);
        print("before", p[i].before, q[i].before);
        print("after", p[i].after, q[i].after);
        print("impulse", p[i].impulse, q[i].impulse);
        printf("\n");
    }
    printf("steps %ld %ld\n", a.steps, b.steps);
}

int main(int, char** argv) {
    try {
        std::ifstream file(argv[1]);
        const Scene scene = read(file);
        const Result coarse = Run(scene, 24, 1e-20L).go(), fine = Run(scene, 31, 1e-21L).go();
        report(fine, coarse);
    } catch (const Refusal& refusal) {
        printf("refused %s\n", refusal.why.c_str());
        return 3;
    }
    return 0;
}
