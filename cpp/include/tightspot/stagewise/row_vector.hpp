// A row of n numbers in as many packs as it fills, the rest one by one.
#pragma once

#include "tightspot/stagewise/pack.hpp"

namespace tightspot::stagewise {

template <int n>
struct RowVector {
    static constexpr int whole = n / lanes, rest = n % lanes;
    Pack packs[whole > 0 ? whole : 1];
    double single[rest > 0 ? rest : 1];

    static RowVector read(const double* from) {
        RowVector row;
        for (int i = 0; i < whole; ++i) row.packs[i] = load<Pack>(from + i * lanes);
        for (int i = 0; i < rest; ++i) row.single[i] = from[whole * lanes + i];
        return row;
    }
    void write(double* to) const {
        for (int i = 0; i < whole; ++i) store(packs[i], to + i * lanes);
        for (int i = 0; i < rest; ++i) to[whole * lanes + i] = single[i];
    }
    // += factor * other
    void add(double factor, const RowVector& other) {
        const Pack all = factor;
        for (int i = 0; i < whole; ++i) packs[i] += all * other.packs[i];
        for (int i = 0; i < rest; ++i) single[i] += factor * other.single[i];
    }
    RowVector times(double factor) const {
        RowVector row;
        for (int i = 0; i < whole; ++i) row.packs[i] = factor * packs[i];
        for (int i = 0; i < rest; ++i) row.single[i] = factor * single[i];
        return row;
    }
    double dot(const RowVector& other) const {
        double sum = 0;
        if constexpr (whole > 0) {
            Pack product = packs[0] * other.packs[0];
            for (int i = 1; i < whole; ++i) product += packs[i] * other.packs[i];
            for (int l = 0; l < lanes; ++l) sum += product[l];
        }
        for (int i = 0; i < rest; ++i) sum += single[i] * other.single[i];
        return sum;
    }
};

}  // namespace tightspot::stagewise
