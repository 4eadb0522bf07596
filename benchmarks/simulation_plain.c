/* The exact method for two masses in plain C: the peer that the package's kernel is measured against.

   Same tables (see kernels/plant.py for a block's layout), same tests of a sample, same search for the first crossing,
   the same records. Written for this plant alone: four states, one input, two elements (backlash, friction), the
   dead-zone law, so that all sizes are constants. gcc's and clang's vectors of four doubles; cc -O3 -march=native. */
#include <math.h>
#include <stdint.h>

typedef double four __attribute__((vector_size(32), aligned(8)));
typedef int64_t mask __attribute__((vector_size(32)));

enum {
    N = 4, C = 6, E = 2, LANES = 4, HEIGHT = 20, LOWER = C * HEIGHT, UPPER = LOWER + 4, HEADER = UPPER + 4,
    SERIES = HEADER + 4, EVENT = 10, MAX_ORDER = 24
};

static inline four load(const double *p) { return *(const four *)p; }
static inline void store(double *p, four x) { *(four *)p = x; }
static inline four splat(double x) { return (four){x, x, x, x}; }
static inline four size_of(four x) { return (four)((mask)x & INT64_MAX); }
static inline four choose(mask m, four a, four b) { return (four)(((mask)a & m) | ((mask)b & ~m)); }
static inline four smaller(four a, four b) { return choose(a < b, a, b); }
static inline four larger(four a, four b) { return choose(a > b, a, b); }
static inline int all(mask m) { return (m[0] & m[1]) & (m[2] & m[3]); }
static inline int any(mask m) { return (m[0] | m[1]) | (m[2] | m[3]); }

/* Four rows of a table whose columns lie `height` apart, times s; column 3 (the motor's angle) is zero. */
static inline four product(const double *table, long height, four x, double v)
{
    four late = load(table + height) * x[1] + load(table + 2 * height) * x[2];
    return (load(table + 4 * height) * v + load(table + 5 * height)) + load(table) * x[0] + late;
}

static inline mask within(const double *block, four g, four d, four swing)
{
    four low = load(block + LOWER), high = load(block + UPPER), end = g + d;
    return (low < g) & (g < high) & (low < end - swing) & (end + swing < high);
}

/* Cubic Hermite with its remainder, for the guards that the first test does not clear. */
static int hermite(const double *block, four x, double v, four g0, four d0, four change, mask inside)
{
    four g1 = g0, d1 = d0, a = size_of(x);
    for (int j = 0; j < N; j++) {
        g1 += load(block + j * HEIGHT + 4) * change[j];
        d1 += load(block + j * HEIGHT + 8) * change[j];
    }
    four b1 = g0 + d0 * (1.0 / 3.0), b2 = g1 - d1 * (1.0 / 3.0);
    four remainder = product(block + 16, HEIGHT, a, fabs(v));
    four lowest = smaller(smaller(g0, g1), smaller(b1, b2)) - remainder;
    four highest = larger(larger(g0, g1), larger(b1, b2)) + remainder;
    return all(inside | ((load(block + LOWER) < lowest) & (highest < load(block + UPPER))));
}

/* Taylor coefficients of order 0 to 3 of a polynomial at t. */
static inline void evaluate(const double *p, int order, double t, double q[4])
{
    double a = p[order], b = 0.0, c = 0.0, d = 0.0;
    for (int k = order - 1; k >= 0; k--) {
        d = d * t + c;
        c = c * t + b;
        b = b * t + a;
        a = a * t + p[k];
    }
    q[0] = a; q[1] = b; q[2] = c; q[3] = d;
}

/* Root of a cubic by the reversed series up to order three; `last`: what its last term does to the value. */
static inline double reversed(double q0, double q1, double q2, double q3, double *last)
{
    double inverse = 1.0 / q1, u = -q0 * inverse, a = q2 * inverse, term = u * u * u * (2.0 * a * a - q3 * inverse);
    *last = fabs(q1 * term);
    return u - a * u * u + term;
}

static inline double only_crossing(const double *p, int order, double sign, double bound, double until,
                                   double tolerance)
{
    double last, q[4], low = 0.0, high = until, t = reversed(p[0] - bound, p[1], p[2], p[3], &last);
    for (int i = 0; i < 100; i++) {
        if (!(low <= t && t <= high)) t = 0.5 * (low + high);
        evaluate(p, order, t, q);
        if (sign * (q[0] - bound) > 0.0) low = t; else high = t;
        t += reversed(q[0] - bound, q[1], q[2], q[3], &last);
        if (last <= tolerance) break;
    }
    return fmin(fmax(t, 0.0), until);
}

/* Steps that end before the first root of a quadratic below the polynomial, so that none is jumped over. */
static double stepped_crossing(const double *p, int order, double sign, double bound, double until, double tolerance)
{
    double third = 0.0, t = 0.0, smallest = 0x1p-50, q[4];
    for (int k = 3; k <= order; k++) third += k * (k - 1.0) * (k - 2.0) * fabs(p[k]);
    for (;;) {
        evaluate(p, order, t, q);
        double value = sign * (q[0] - bound), slope = sign * q[1], left = until - t;
        if (value < -tolerance) return t;
        if (left <= 0.0) return 2.0;
        double curvature = 2.0 * sign * q[2] - third * left;
        if (curvature >= 0.0 && slope >= 0.0) return 2.0;
        value = fmax(value, 0.0);
        double square = slope * slope - 2.0 * curvature * value;
        if (square < 0.0) return 2.0;
        double step = slope < 0.0 ? 2.0 * value / (-slope + sqrt(square)) : (slope + sqrt(square)) / -curvature;
        if (step >= left) return 2.0;
        if (step < smallest) { step = smallest; smallest *= 2.0; }
        t += step;
    }
}

/* First time in [0, until] at which sign (p - bound) falls below zero; 2 if it does not. */
static inline double first_crossing(const double *p, int order, double sign, double bound, double until, double bend,
                                    double tolerance)
{
    double value = sign * (p[0] - bound), slope = sign * p[1], change = bend * until, q[4];
    if (value < -tolerance || fabs(slope) <= change)
        return stepped_crossing(p, order, sign, bound, until, tolerance);
    if (slope > 0.0) return 2.0;
    if (value + (slope + change) * until >= -tolerance) {
        evaluate(p, order, until, q);
        if (sign * (q[0] - bound) >= -tolerance) return 2.0;
    }
    return only_crossing(p, order, sign, bound, until, tolerance);
}

/* Taylor series of a guard, to p; returns a bound on the change of its slope. */
static inline double expand(const double *table, int rows, int order, four x, double v, double *p)
{
    four value = product(table, rows, x, v), bend = size_of(value) * (four){0.0, 0.0, 2.0, 3.0};
    four weight = {4.0, 5.0, 6.0, 7.0};
    store(p, value);
    for (int n = LANES; n <= order; n += LANES) {
        value = product(table + n, rows, x, v);
        store(p + n, value);
        bend += size_of(value) * weight;
        weight += 4.0;
    }
    return (bend[0] + bend[2]) + (bend[1] + bend[3]);
}

/* First crossing of any guard within `time` samples: time in pieces, element (-1: none), direction. */
static inline double next_event(const double *block, four x, double v, int order, int stride, double length,
                                double time, int *which, int *direction)
{
    int rows = (stride + 4) / 4 * 4;
    const double *taylor = block + SERIES + stride * C * 4;
    double first = time / length, p[MAX_ORDER + 5];
    four a = size_of(x), g = product(block + 4, HEIGHT, x, v), d = product(block + 8, HEIGHT, x, v);
    four swing = product(block + 12, HEIGHT, a, fabs(v)), sum = size_of(load(block + 5 * HEIGHT + 4));
    sum += size_of(load(block + 4)) * a[0] + size_of(load(block + HEIGHT + 4)) * a[1];
    sum += size_of(load(block + 2 * HEIGHT + 4)) * a[2] + size_of(load(block + 4 * HEIGHT + 4)) * fabs(v);
    four tolerance = (sum + size_of(d) + swing) * 4.5e-16, low = load(block + LOWER), high = load(block + UPPER);
    four end = g + d * time, sway = swing * (time * time);
    mask below = (g + tolerance < low) | (end - sway < low), above = (high < g - tolerance) | (high < end + sway);
    *which = -1;
    *direction = 0;
    if (!any(below | above)) return first;
    for (int e = 0; e < E; e++) {
        if (!(below[e] | above[e])) continue;
        double bend = expand(taylor + e * C * rows, rows, order, x, v, p);
        if (below[e]) {
            double found = first_crossing(p, order, 1.0, low[e], first, bend, tolerance[e]);
            if (found <= first) { first = found; *which = e; *direction = -1; }
        }
        if (above[e]) {
            double found = first_crossing(p, order, -1.0, high[e], first, bend, tolerance[e]);
            if (found <= first) { first = found; *which = e; *direction = 1; }
        }
    }
    return first;
}

/* The state after `time` pieces, even and odd orders of its series apart. */
static inline four advance(const double *table, four x, double v, int order, double time)
{
    double square = time * time;
    four even = splat(0.0), odd = splat(0.0);
    int n = order - 1;
    if (order % 2) odd = product(table + n-- * C * 4, 4, x, v);
    for (; n > 0; n -= 2) {
        even = even * square + product(table + n * C * 4, 4, x, v);
        odd = odd * square + product(table + (n - 1) * C * 4, 4, x, v);
    }
    return x + time * (even * time + odd);
}

static four finish(const double *flat, const int64_t *mode_row, int stride, long size, four x, double v,
                   int64_t *digits, long k, double *events, long *count)
{
    double t = 0.0;
    while (t < 1.0) {
        long m = mode_row[3 * digits[0] + digits[1]];
        if (m < 0) { *count = -1; return x; }
        const double *block = flat + m * size;
        double length = block[HEADER], left = 1.0 - t;
        int order = (int)block[HEADER + 1], whole = left <= length, which, direction;
        double first = next_event(block, x, v, order, stride, length, whole ? left : length, &which, &direction);
        if (first > 0.0) x = advance(block + SERIES, x, v, order, first);
        if (which < 0) { t = whole ? 1.0 : t + length; continue; }
        t += first * length;
        int64_t old = digits[which];
        digits[which] += direction;
        double *event = events + (*count)++ * EVENT;
        event[0] = k + t;
        event[1] = which;
        event[2] = old;
        event[3] = digits[which];
        event[4] = which == 1 ? x[2] : x[1] - x[2];
        event[5] = 3 * digits[0] + digits[1];
        if (which == 1 && digits[1] == 1) x[2] = 0.0;
        store(event + 6, x);
    }
    return x;
}

/* states: (n + 1) x 4, modes: n + 1, events: enough rows of 10; returns the number of events, -1 if a mode is
   missing. */
long run(const double *restrict flat, const int64_t *restrict mode_row, int order, double *s, int64_t *digits,
         const double *restrict input, long n, double *restrict states, int64_t *restrict modes,
         double *restrict events)
{
    long count = 0, size = SERIES + order * C * 4 + E * C * ((order + 4) / 4 * 4), mode = 3 * digits[0] + digits[1];
    four x = load(s);
    const double *block = flat + mode_row[mode] * size;
    if (mode_row[mode] < 0) return -1;
    for (long k = 0; k < n; k++) {
        double v = input[k];
        store(states + 4 * k, x);
        modes[k] = mode;
        four g = product(block + 4, HEIGHT, x, v), d = product(block + 8, HEIGHT, x, v);
        four change = product(block, HEIGHT, x, v);
        mask inside = within(block, g, d, product(block + 12, HEIGHT, size_of(x), fabs(v)));
        if (all(inside) || hermite(block, x, v, g, d, change, inside)) {
            x += change;
            continue;
        }
        x = finish(flat, mode_row, order, size, x, v, digits, k, events, &count);
        mode = 3 * digits[0] + digits[1];
        if (count < 0 || mode_row[mode] < 0) return -1;
        block = flat + mode_row[mode] * size;
    }
    store(states + 4 * n, x);
    modes[n] = mode;
    store(s, x);
    return count;
}
