/* The exact method for two masses in plain C: the peer that the package's kernel is measured against.

   Same tables (see kernels/plant.py), same two tests per sample, same search for the first crossing. Four states,
   one input, two elements (backlash, friction); sizes are constants. */
#include <math.h>
#include <stdint.h>

enum { N = 4, C = 6, E = 2, MAX_ORDER = 24 };

static double row(const double *r, const double *s)
{
    return (r[5] + r[4] * s[4]) + r[0] * s[0] + (r[1] * s[1] + r[2] * s[2]);
}

static int quiet(const double *block, const double *s, double *change)
{
    double size[C] = {fabs(s[0]), fabs(s[1]), fabs(s[2]), 0.0, fabs(s[4]), 1.0};
    const double *bounds = block + (N + 4 * E) * C;
    for (int i = 0; i < N; i++) change[i] = row(block + i * C, s);
    for (int e = 0; e < E; e++) {
        const double *g = block + (N + 4 * e) * C;
        double g0 = row(g, s), d0 = row(g + C, s), swing = row(g + 2 * C, size);
        double low = bounds[2 * e], high = bounds[2 * e + 1];
        if (g0 + fmin(d0, 0.0) - swing > low && g0 + fmax(d0, 0.0) + swing < high) continue;
        double g1 = g0, d1 = d0, remainder = row(g + 3 * C, size);
        for (int j = 0; j < N; j++) { g1 += g[j] * change[j]; d1 += g[C + j] * change[j]; }
        double b1 = g0 + d0 / 3.0, b2 = g1 - d1 / 3.0;
        if (!(fmin(fmin(g0, g1), fmin(b1, b2)) - remainder > low &&
              fmax(fmax(g0, g1), fmax(b1, b2)) + remainder < high))
            return 0;
    }
    return 1;
}

/* First time in [0, until] at which sign (p - bound) falls below zero; 2 if it does not. */
static double crossing(const double *p, int order, double sign, double bound, double until, double tolerance)
{
    double third = 0.0, t = 0.0, smallest = 0x1p-50;
    for (int k = 3; k <= order; k++) third += k * (k - 1) * (k - 2) * fabs(p[k]);
    for (;;) {
        double q = p[order], q1 = 0.0, q2 = 0.0;
        for (int k = order - 1; k >= 0; k--) { q2 = q2 * t + q1; q1 = q1 * t + q; q = q * t + p[k]; }
        q = sign * (q - bound); q1 *= sign; q2 *= 2.0 * sign;
        if (q < -tolerance) return t;
        double left = until - t;
        if (left <= 0.0) return 2.0;
        double curvature = q2 - third * left;
        if (curvature >= 0.0 && q1 >= 0.0) return 2.0;
        if (q < 0.0) q = 0.0;
        double square = q1 * q1 - 2.0 * curvature * q;
        if (square < 0.0) return 2.0;
        double step = q1 < 0.0 ? 2.0 * q / (-q1 + sqrt(square)) : (q1 + sqrt(square)) / -curvature;
        if (step >= left) return 2.0;
        if (step < smallest) { step = smallest; smallest *= 2.0; }
        t += step;
    }
}

static long finish(const double *flat, const int64_t *mode_row, int order, double *s, int64_t *digits, long count)
{
    int guards = E * (order + 1), width = guards + order * N;
    long size = (N + 4 * E) * C + 2 * E + 1 + C * width;
    double series[E * (MAX_ORDER + 1) + MAX_ORDER * N], t = 0.0;
    for (;;) {
        long m = mode_row[3 * digits[0] + digits[1]];
        if (m < 0) return -1;
        if (t >= 1.0) return count;
        const double *block = flat + m * size, *rows = block + N * C, *bounds = rows + 4 * E * C;
        const double *taylor = bounds + 2 * E + 1;
        double length = bounds[2 * E];
        int whole = 1.0 - t <= length;
        double until = whole ? (1.0 - t) / length : 1.0, first = until;
        for (int v = 0; v < width; v++)
            series[v] = taylor[v] * s[0] + taylor[width + v] * s[1] + taylor[2 * width + v] * s[2] +
                        taylor[4 * width + v] * s[4] + taylor[5 * width + v];
        int which = -1, direction = 0;
        for (int e = 0; e < E; e++) {
            const double *p = series + e * (order + 1), *g = rows + 4 * e * C;
            double spread = 0.0, terms = fabs(g[5]);
            for (int k = 1; k <= order; k++) spread += fabs(p[k]);
            for (int j = 0; j < 5; j++) terms += fabs(g[j] * s[j]);
            double tolerance = 4.5e-16 * (spread + terms), reach = spread * first + tolerance;
            for (int side = 0; side < 2; side++) {
                double bound = bounds[2 * e + side], sign = side ? -1.0 : 1.0;
                if (sign * (p[0] - bound) > reach) continue;
                double found = crossing(p, order, sign, bound, first, tolerance);
                if (found <= first) { first = found; which = e; direction = side ? 1 : -1; }
            }
        }
        if (first > 0.0)
            for (int i = 0; i < N; i++) {
                double total = series[width - N + i];
                for (int n = order - 2; n >= 0; n--) total = total * first + series[guards + n * N + i];
                s[i] += total * first;
            }
        if (which < 0) { t = whole ? 1.0 : t + length; continue; }
        t += first * length;
        digits[which] += direction;
        if (which == 1 && digits[1] == 1) s[2] = 0.0;
        count++;
    }
}

/* states: (n + 1) x 4; returns the number of events, -1 if a mode is missing. */
long run(const double *flat, const int64_t *mode_row, int order, double *s, int64_t *digits, const double *input,
         long n, double *states)
{
    long count = 0, size = (N + 4 * E) * C + 2 * E + 1 + C * (E * (order + 1) + order * N);
    double change[N];
    for (long k = 0; k < n; k++) {
        long m = mode_row[3 * digits[0] + digits[1]];
        if (m < 0) return -1;
        s[4] = input[k];
        for (int i = 0; i < N; i++) states[k * N + i] = s[i];
        if (quiet(flat + m * size, s, change))
            for (int i = 0; i < N; i++) s[i] += change[i];
        else if ((count = finish(flat, mode_row, order, s, digits, count)) < 0)
            return -1;
    }
    for (int i = 0; i < N; i++) states[n * N + i] = s[i];
    return count;
}
