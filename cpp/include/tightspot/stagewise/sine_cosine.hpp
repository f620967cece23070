// Sine and cosine of one angle or a pack of them, inline, so that several can be under way at once.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "tightspot/stagewise/pack.hpp"

namespace tightspot::stagewise {

namespace detail {

// Taylor series for |x| <= pi/4.
template <class P>
inline void short_series(P x, P& s, P& c) {
    const P y = x * x;
    s = -1.0 / 1307674368000.0 + y * (1.0 / 355687428096000.0);
    s = 1.0 / 6227020800.0 + y * s, s = -1.0 / 39916800.0 + y * s, s = 1.0 / 362880.0 + y * s;
    s = -1.0 / 5040.0 + y * s, s = 1.0 / 120.0 + y * s, s = -1.0 / 6.0 + y * s;
    s = x + x * y * s;
    c = -1.0 / 87178291200.0 + y * (1.0 / 20922789888000.0);
    c = 1.0 / 479001600.0 + y * c, c = -1.0 / 3628800.0 + y * c, c = 1.0 / 40320.0 + y * c;
    c = -1.0 / 720.0 + y * c, c = 1.0 / 24.0 + y * c, c = 1.0 - 0.5 * y + y * y * c;
}

constexpr double two_over_pi = 0.63661977236758134308;
// pi/2 in two parts, the first with trailing zeros so that its multiples are exact.
constexpr double half_pi_high = 1.57079632673412561417, half_pi_low = 6.07710050650619224932e-11;
constexpr double shifter = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer, left in the lowest bits

}  // namespace detail

// Series after reduction to [-pi/4, pi/4]; within 2e-16 for moderate angles. Huge ones and NaN go to <cmath>.
inline void sine_cosine(double angle, double& sine, double& cosine) {
    using namespace detail;
    if (!(std::abs(angle) < 1e4)) {
        sine = std::sin(angle), cosine = std::cos(angle);
        return;
    }
    const double quarters = (angle * two_over_pi + shifter) - shifter;
    double s, c;
    short_series((angle - quarters * half_pi_high) - quarters * half_pi_low, s, c);
    const int quadrant = static_cast<int>(quarters) & 3;
    const double a = quadrant & 1 ? c : s, b = quadrant & 1 ? s : c;
    sine = quadrant & 2 ? -a : a;
    cosine = (quadrant + 1) & 2 ? -b : b;
}

inline void sine_cosine(Pack angle, Pack& sine, Pack& cosine) {
    using namespace detail;
    Pack most = magnitude(angle);
    bool huge = false;
    for (int l = 0; l < lanes; ++l) huge |= !(most[l] < 1e4);
    if (huge) {
        for (int l = 0; l < lanes; ++l) {
            double s, c;
            sine_cosine(angle[l], s, c);
            sine.set(l, s), cosine.set(l, c);
        }
        return;
    }
    const Pack shifted = angle * two_over_pi + shifter, quarters = shifted - shifter;
    Pack s, c;
    short_series((angle - quarters * half_pi_high) - quarters * half_pi_low, s, c);
    Pack::Integers quadrant, a, b;
    std::memcpy(&quadrant, &shifted, sizeof quadrant), std::memcpy(&a, &s, sizeof a), std::memcpy(&b, &c, sizeof b);
    const Pack::Integers odd = -(quadrant & 1), swap = (a ^ b) & odd;
    a = (a ^ swap) ^ ((quadrant & 2) << 62), b = (b ^ swap) ^ (((quadrant + 1) & 2) << 62);
    std::memcpy(&sine, &a, sizeof a), std::memcpy(&cosine, &b, sizeof b);
}

}  // namespace tightspot::stagewise
