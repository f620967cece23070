// Sums, extremes and logarithms of long arrays, taken pack by pack (see over_packs): the order of summation is the
// code's, so that compilers need no licence to reorder to make them fast.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#include "tightspot/stagewise/pack.hpp"

namespace tightspot::stagewise {

class Sum {
   public:
    void add(Pack p) { packs_ += p; }
    void add(double x) { rest_ += x; }
    double value() const {
        double sum = rest_;
        for (int l = 0; l < lanes; ++l) sum += packs_[l];
        return sum;
    }

   private:
    Pack packs_ = 0.0;
    double rest_ = 0;
};

// The largest of what is added and `least`; not a number counts as nothing (a Sum tells of it).
class Most {
   public:
    explicit Most(double least) : packs_(least), rest_(least) {}
    void add(Pack p) { packs_ = larger(p, packs_); }
    void add(double x) { rest_ = larger(x, rest_); }
    double value() const {
        double most = rest_;
        for (int l = 0; l < lanes; ++l) most = larger(packs_[l], most);
        return most;
    }

   private:
    Pack packs_;
    double rest_;
};

// Sum of the logarithms of positive numbers: they are multiplied, and the product's exponent taken out now and then.
class Logarithms {
   public:
    void add(Pack p) {
        product_ *= p;
        if (++count_ % often == 0) take_exponents();
    }
    void add(double x) {
        rest_ *= x;
        if (++rest_count_ % often == 0) take_rest();
    }
    // False if a product left the range of numbers, or was none; then the sum must be taken the long way.
    bool usable() {
        take_exponents(), take_rest();
        bool all = check_ == 0 && least_rest_ > tiny;
        for (int l = 0; l < lanes; ++l) all = all && check_packs_[l] == 0 && least_[l] > tiny;
        return all;
    }
    // After `usable`.
    double value() const {
        double product = 1, exponents = 0;
        for (int l = 0; l < lanes; ++l) {
            product *= product_[l];
            exponents += number(exponents_, l) - 1023.0 * taken_;
        }
        return std::log(product) + exponents * 0.69314718055994530942 + rest_logs_;
    }

   private:
    static constexpr int often = 4;
    static constexpr double tiny = 1e-290;
    static double number(const Pack::Integers& integers, int l) {
#if defined(__GNUC__)
        return static_cast<double>(integers[l]);
#else
        return static_cast<double>(integers);
#endif
    }

    void take_exponents() {
        check_packs_ += product_ * 0.0;
        least_ = smaller(product_, least_);
        Pack::Integers bits;
        std::memcpy(&bits, &product_, sizeof bits);
        exponents_ += bits >> 52;
        bits = (bits & 0xfffffffffffff) | 0x3ff0000000000000;
        std::memcpy(&product_, &bits, sizeof bits);
        ++taken_;
    }
    void take_rest() {
        check_ += rest_ * 0.0;
        least_rest_ = smaller(rest_, least_rest_);
        rest_logs_ += std::log(rest_);
        rest_ = 1;
    }

    Pack product_ = 1.0, check_packs_ = 0.0, least_ = 1.0;
    Pack::Integers exponents_{};
    int count_ = 0, rest_count_ = 0, taken_ = 0;
    double rest_ = 1, check_ = 0, least_rest_ = 1, rest_logs_ = 0;
};

// Largest absolute value; not a number if any of them is none.
inline double largest_magnitude(const double* values, std::size_t n) {
    Most most(0.0);
    Sum check;
    over_packs(n, [&](auto zero, std::size_t i) {
        const auto p = load<decltype(zero)>(values + i);
        most.add(magnitude(p)), check.add(p * 0.0);
    });
    return check.value() == 0 ? most.value() : check.value() + HUGE_VAL;
}

inline double sum_of_magnitudes(const double* values, std::size_t n) {
    Sum sum;
    over_packs(n, [&](auto zero, std::size_t i) { sum.add(magnitude(load<decltype(zero)>(values + i))); });
    return sum.value();
}

}  // namespace tightspot::stagewise
