// A line's 2 x 2 block of the Newton system, inverted, and the step it gives.
#pragma once

#include "tightspot/stagewise/pack.hpp"

namespace tightspot::stagewise {

template <class P>
struct LineInverse {
    P phi_phi, phi_mu, mu_mu;
};

// Inverse of [[a, b], [b, d]] with d > 0. If its Schur complement a - b^2/d is not clearly positive, a is raised so that
// the complement becomes its own absolute value: the line's own convexification, which leaves the vehicle's alone.
template <class P>
inline LineInverse<P> invert_line(P a, P b, P d) {
    // a is a sum as large as b^2/d; what is left of it must stand out from its rounding.
    const P ratio = b / d, floor = larger(1e-13 * magnitude(b * ratio), P(1e-10)), rest = a - b * ratio;
    const P inverse = 1.0 / choose(rest, floor, rest, larger(magnitude(rest), 10.0 * floor));
    return {inverse, -inverse * ratio, 1.0 / d + inverse * ratio * ratio};
}

// The same for a group's lines, of the three packs read, kept in `inverses`.
template <class P>
inline LineInverse<P> invert_lines(Reader<P>& block, double* inverses) {
    const P a = block.next(), b = block.next(), d = block.next();
    const LineInverse<P> inverse = invert_line<P>(a, b, d);
    Writer<P> kept{inverses};
    kept.put(inverse.phi_phi), kept.put(inverse.phi_mu), kept.put(inverse.mu_mu);
    return inverse;
}

// The step of lines, phi and mu, by their inverses for the given gradient.
template <class P>
struct LineStep {
    P phi, mu;

    LineStep(const double* inverses, const double* gradient, P more_phi = 0.0, P more_mu = 0.0) {
        Reader<P> inverse{inverses}, g{gradient};
        const P a = inverse.next(), b = inverse.next(), d = inverse.next();
        const P g_phi = g.next() + more_phi, g_mu = g.next() + more_mu;
        phi = -a * g_phi - b * g_mu, mu = -b * g_phi - d * g_mu;
    }
};

}  // namespace tightspot::stagewise
