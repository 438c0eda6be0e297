/* Written by tractive_sam; see @NAME@.h. */
#include "@NAME@.h"
#include <math.h>
#include <stddef.h>

@DATA@/* Weights of value and slope at both ends, or their derivatives: [end][value, slope]. */
static void @NAME@_cubics(double t, double h, int slope, double w[2][2]) {
    double s = 1.0 - t, r = 6.0 * t * s / h;
    w[0][0] = slope ? -r : s * s * (1.0 + 2.0 * t);
    w[0][1] = slope ? s * (1.0 - 3.0 * t) : h * t * s * s;
    w[1][0] = slope ? r : t * t * (3.0 - 2.0 * t);
    w[1][1] = slope ? t * (3.0 * t - 2.0) : -h * t * t * s;
}

/* Interpolated values, or their derivatives by one of the axes (by >= 0). */
static void @NAME@_law(const double *at, int by, double f[3]) {
    double w[@N@][2][2];
    int cell[@N@], k, m, corner, d;
    for (k = 0; k < @N@; k++) {
        const double *x = @NAME@_nodes[k];
        double h, t;
        int i = 0;
        while (i < @NAME@_count[k] - 2 && at[k] >= x[i + 1]) i++;
        h = x[i + 1] - x[i];
        t = (at[k] - x[i]) / h;
        t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
        cell[k] = i;
        @NAME@_cubics(t, h, k == by, w[k]);
    }
    f[0] = f[1] = f[2] = 0.0;
    for (corner = 0; corner < (1 << @N@); corner++) {
        long place = 0;
        for (k = 0; k < @N@; k++)
            place = place * @NAME@_count[k] + cell[k] + (corner >> (@N@ - 1 - k) & 1);
        for (d = 0; d < (1 << @N@); d++) {
            double weight = 1.0;
            for (k = 0; k < @N@; k++)
                weight *= w[k][corner >> (@N@ - 1 - k) & 1][d >> (@N@ - 1 - k) & 1];
            for (m = 0; m < 3; m++)
                f[m] += weight * @NAME@_data[(place * (1 << @N@) + d) * 3 + m];
        }
    }
}

int @NAME@(@ARGUMENTS@,
           double force[3], double *gradient) {
@CONSTANTS@    const double given[5] = {a, b, load, mu, shear};
    const double every[] = {@ALONG@, 0.0, 0.0, 0.0};
    double w[3] = {xi_x, xi_y, spin}, sign[3] = {1.0, 1.0, 1.0}, scale[3], unit[3], at[@N@], f[3];
    double c, x, y, kappa, t, r, r0, u, heading, tilt;
    int k, m, n, endless = 0;
    for (k = 0; k < 3; k++) {
        if (isnan(w[k])) return 1;
        endless += isinf(w[k]) != 0;
    }
    if (endless > 1) return 1;
    if (load == 0.0) { /* the bodies do not touch */
        for (k = 0; k < 3; k++) force[k] = 0.0;
        for (k = 0; gradient && k < 9; k++) gradient[k] = 0.0;
        return 0;
    }
    for (k = 0; k < 5; k++)
        if (!(given[k] > 0.0) || isinf(given[k])) return 2;
@CHECKS@    c = sqrt(a * b);
    unit[0] = unit[1] = mu * load;
    unit[2] = mu * load * c;
    scale[0] = scale[1] = shear * (c * c) / (mu * load);
    scale[2] = scale[0] * c;
    for (k = 0; k < 3; k++) {
        w[k] *= scale[k];
        if (endless) w[k] = isinf(w[k]) ? (w[k] > 0.0 ? 1.0 : -1.0) : 0.0;
    }
    if (w[2] < 0.0 && !@WHOLE@) sign[1] = sign[2] = -1.0;
    if (w[0] < 0.0 && !@WHOLE@) sign[0] = -1.0;
    x = sign[0] * w[0] + 0.0; /* of -0, atan2 would make a heading of pi */
    y = sign[1] * w[1] + 0.0;
    kappa = sign[2] * w[2] * @SPIN@;
    r0 = 2.0 / (3.2 + 0.9 * (a / b));
    t = hypot(x, y);
    r = hypot(t, kappa);
    u = endless ? 1.0 : r / (r + r0);
    heading = atan2(y, x);
    tilt = atan2(kappa, t);
    for (k = 0; k < @N@ - 3; k++) at[k] = every[@NAME@_axis[k]];
    at[@N@ - 3] = heading;
    at[@N@ - 2] = tilt;
    at[@N@ - 1] = u;
    @NAME@_law(at, -1, f);
    for (k = 0; k < 3; k++) force[k] = unit[k] * sign[k] * f[k];
    if (gradient) {
        double ch = cos(heading), sh = sin(heading), ct = cos(tilt), st = sin(tilt), stretch;
        double by[3][3], slope[3][3] = {{0.0}};
        const double most = 0.5 * @PI@ - @POLE@;
        at[@N@ - 2] = tilt > most ? most : tilt < -most ? -most : tilt;
        at[@N@ - 1] = u < @MIN_RADIUS@ ? @MIN_RADIUS@ : u;
        if (t < @POLE@ * r) t = @POLE@ * r;
        if (r <= @MIN_RADIUS@ * r0) r = t = @MIN_RADIUS@ * r0;
        stretch = r0 / (r + r0) / (r + r0);
        by[0][0] = -sh / t;
        by[0][1] = ch / t;
        by[0][2] = 0.0;
        by[1][0] = -st * ch / r;
        by[1][1] = -st * sh / r;
        by[1][2] = @SPIN@ * ct / r;
        by[2][0] = stretch * ct * ch;
        by[2][1] = stretch * ct * sh;
        by[2][2] = @SPIN@ * stretch * st;
        for (k = 0; k < 3; k++) {
            @NAME@_law(at, @N@ - 3 + k, f);
            for (m = 0; m < 3; m++) slope[m][k] = f[m];
        }
        for (m = 0; m < 3; m++)
            for (n = 0; n < 3; n++) {
                double sum = 0.0;
                for (k = 0; k < 3; k++) sum += slope[m][k] * by[k][n];
                gradient[3 * m + n] = endless ? 0.0 : unit[m] * sign[m] * sum * sign[n] * scale[n];
            }
    }
    return 0;
}
