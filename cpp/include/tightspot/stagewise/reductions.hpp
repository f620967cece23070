// Sums and maxima over long arrays, in eight lanes, so that compilers need no licence to reorder to make them fast.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tightspot::stagewise {

constexpr std::size_t lanes = 8;

// Sum of term(i) for i < n.
template <class Term>
double total(std::size_t n, Term&& term) {
    double partial[lanes] = {};
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes)
        for (std::size_t l = 0; l < lanes; ++l) partial[l] += term(i + l);
    double sum = 0;
    for (; i < n; ++i) sum += term(i);
    for (double part : partial) sum += part;
    return sum;
}

// The largest term(i) that is above `least`; not a number counts as nothing (see `total` for a check).
template <class Term>
double largest(std::size_t n, double least, Term&& term) {
    double partial[lanes];
    for (double& part : partial) part = least;
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes)
        for (std::size_t l = 0; l < lanes; ++l) {
            const double value = term(i + l);
            partial[l] = value > partial[l] ? value : partial[l];
        }
    double most = least;
    for (; i < n; ++i) {
        const double value = term(i);
        most = value > most ? value : most;
    }
    for (double part : partial) most = part > most ? part : most;
    return most;
}

// Largest absolute value; not a number if any of them is none.
template <class Term>
double largest_magnitude(std::size_t n, Term&& term) {
    const double most = largest(n, 0.0, [&](std::size_t i) { return std::abs(term(i)); });
    const double check = total(n, [&](std::size_t i) { return std::abs(term(i)); });
    return std::isnan(check) ? check : most;
}

// Sum of the logarithms of positive numbers: products of eight first, if they neither overflow nor vanish.
template <class Term>
double sum_of_logs(std::size_t n, Term&& term) {
    double sum = 0;
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) {
        double product = 1;
        for (std::size_t l = 0; l < lanes; ++l) product *= term(i + l);
        if (product > 1e-290 && product < 1e290) {
            sum += std::log(product);
            continue;
        }
        for (std::size_t l = 0; l < lanes; ++l) sum += std::log(term(i + l));
    }
    for (; i < n; ++i) sum += std::log(term(i));
    return sum;
}

}  // namespace tightspot::stagewise
