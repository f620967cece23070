// Sine and cosine of one angle, inline, so that several can be under way at once.
#pragma once

#include <cmath>

namespace tightspot::stagewise {

// Taylor series after reduction to [-pi/4, pi/4]; within 2e-16 for moderate angles. Huge ones and NaN go to <cmath>.
inline void sine_cosine(double angle, double& sine, double& cosine) {
    constexpr double two_over_pi = 0.63661977236758134308;
    // pi/2 in two parts, the first with trailing zeros so that its multiples are exact.
    constexpr double high = 1.57079632673412561417, low = 6.07710050650619224932e-11;
    if (!(std::abs(angle) < 1e4)) {
        sine = std::sin(angle), cosine = std::cos(angle);
        return;
    }
    constexpr double shifter = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
    const double quarters = (angle * two_over_pi + shifter) - shifter;
    const double x = (angle - quarters * high) - quarters * low, y = x * x;
    double s = -1.0 / 1307674368000.0 + y * (1.0 / 355687428096000.0);
    s = 1.0 / 6227020800.0 + y * s, s = -1.0 / 39916800.0 + y * s, s = 1.0 / 362880.0 + y * s;
    s = -1.0 / 5040.0 + y * s, s = 1.0 / 120.0 + y * s, s = -1.0 / 6.0 + y * s;
    s = x + x * y * s;
    double c = -1.0 / 87178291200.0 + y * (1.0 / 20922789888000.0);
    c = 1.0 / 479001600.0 + y * c, c = -1.0 / 3628800.0 + y * c, c = 1.0 / 40320.0 + y * c;
    c = -1.0 / 720.0 + y * c, c = 1.0 / 24.0 + y * c, c = 1.0 - 0.5 * y + y * y * c;
    const int quadrant = static_cast<int>(quarters) & 3;
    const double a = quadrant & 1 ? c : s, b = quadrant & 1 ? s : c;
    sine = quadrant & 2 ? -a : a;
    cosine = (quadrant + 1) & 2 ? -b : b;
}

}  // namespace tightspot::stagewise
