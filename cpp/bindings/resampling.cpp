// Motions on other knots.
#include "resampling.hpp"

#include <nanobind/ndarray.h>

#include <cstddef>

#include "arrays.hpp"
#include "tightspot/resampling.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace tightspot;

namespace {

using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

void need(bool holds, const char* sentence) {
    if (!holds) throw nb::value_error(sentence);
}

Knots knots(const Numbers& t, std::size_t rows, std::size_t columns) {
    need(t.size() >= 2, "a motion has two knots or more");
    need(columns >= 1, "a motion has states and inputs");
    need(rows == t.size(), "a motion needs a row for each knot, and inputs for each interval");
    return {t.data(), t.size(), columns};
}

Table states_at(const Numbers& t, const Rows& states, const Numbers& times) {
    const Knots known = knots(t, states.shape(0), states.shape(1));
    return table(interpolated(known, states.data(), times.data(), times.size()), known.columns);
}

Table inputs_on(const Numbers& t, const Rows& inputs, const Numbers& times) {
    const Knots known = knots(t, inputs.shape(0) + 1, inputs.shape(1));
    need(times.size() >= 1, "intervals need times between which they are");
    return table(means(known, inputs.data(), times.data(), times.size()), known.columns);
}

}  // namespace

void bind_resampling(nb::module_& m) {
    m.def("states_at", &states_at, "t"_a, "states"_a, "times"_a);
    m.def("inputs_on", &inputs_on, "t"_a, "inputs"_a, "times"_a);
}
