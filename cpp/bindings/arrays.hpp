// Numbers handed over to NumPy without a copy.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <memory>
#include <utility>
#include <vector>

namespace tightspot {

using Table = nanobind::ndarray<nanobind::numpy, double, nanobind::ndim<2>>;
using Column = nanobind::ndarray<nanobind::numpy, double, nanobind::ndim<1>>;

template <class Number>
Number* hand_over(std::vector<Number> values, nanobind::capsule& owner) {
    auto kept = std::make_unique<std::vector<Number>>(std::move(values));
    Number* data = kept->data();
    owner = nanobind::capsule(kept.release(),
                              [](void* p) noexcept { delete static_cast<std::vector<Number>*>(p); });
    return data;
}

/// Rows one after the other.
inline Table table(std::vector<double> values, std::size_t columns) {
    nanobind::capsule owner;
    const std::size_t rows = values.size() / columns;
    double* data = hand_over(std::move(values), owner);
    return Table(data, {rows, columns}, owner);
}

template <class Number>
nanobind::ndarray<nanobind::numpy, Number, nanobind::ndim<1>> column(std::vector<Number> values) {
    nanobind::capsule owner;
    const std::size_t size = values.size();
    Number* data = hand_over(std::move(values), owner);
    return nanobind::ndarray<nanobind::numpy, Number, nanobind::ndim<1>>(data, {size}, owner);
}

/// The same of other numbers.
template <class Number>
nanobind::ndarray<nanobind::numpy, Number, nanobind::ndim<2>> table_of(std::vector<Number> values, std::size_t columns) {
    nanobind::capsule owner;
    const std::size_t rows = values.size() / columns;
    Number* data = hand_over(std::move(values), owner);
    return nanobind::ndarray<nanobind::numpy, Number, nanobind::ndim<2>>(data, {rows, columns}, owner);
}

}  // namespace tightspot
