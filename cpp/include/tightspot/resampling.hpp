// Columns of numbers over time, between knots: states are linear there, inputs constant.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tightspot {

// `columns` numbers at each of the knots, whose times t increase; two knots or more.
struct Knots {
    const double* t;
    std::size_t count;
    std::size_t columns;
};

// values (count, columns), linearly interpolated at a time; the first and last knot's before and after them.
inline void interpolate(const Knots& knots, const double* values, double time, double* into) {
    const std::size_t n = knots.columns, last = knots.count - 1;
    if (time <= knots.t[0] || time >= knots.t[last]) {
        const double* end = values + (time <= knots.t[0] ? 0 : last) * n;
        std::copy(end, end + n, into);
        return;
    }
    const std::size_t above = static_cast<std::size_t>(std::upper_bound(knots.t, knots.t + last, time) - knots.t);
    const std::size_t k = std::max<std::size_t>(above, 1) - 1;
    const double *from = values + k * n, *to = from + n, width = knots.t[k + 1] - knots.t[k];
    for (std::size_t i = 0; i < n; ++i) into[i] = (to[i] - from[i]) / width * (time - knots.t[k]) + from[i];
}

// Values (count, columns) at the times, (times, columns).
inline std::vector<double> interpolated(const Knots& knots, const double* values, const double* times, std::size_t count) {
    std::vector<double> result(count * knots.columns);
    for (std::size_t i = 0; i < count; ++i) interpolate(knots, values, times[i], result.data() + i * knots.columns);
    return result;
}

// Means of inputs (knots - 1, columns), constant between the knots, over what is between the times, (times - 1, columns).
inline std::vector<double> means(const Knots& knots, const double* inputs, const double* times, std::size_t count) {
    const std::size_t n = knots.columns;
    std::vector<double> integral(knots.count * n, 0.0);
    for (std::size_t k = 0; k + 1 < knots.count; ++k)
        for (std::size_t i = 0; i < n; ++i)
            integral[(k + 1) * n + i] = integral[k * n + i] + inputs[k * n + i] * (knots.t[k + 1] - knots.t[k]);
    const std::vector<double> until = interpolated(knots, integral.data(), times, count);
    std::vector<double> result((count - 1) * n);
    for (std::size_t k = 0; k + 1 < count; ++k)
        for (std::size_t i = 0; i < n; ++i)
            result[k * n + i] = (until[(k + 1) * n + i] - until[k * n + i]) / (times[k + 1] - times[k]);
    return result;
}

}  // namespace tightspot
