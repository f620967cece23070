// A few doubles that are computed with at once: as many as the processor's registers hold, one if the compiler has none.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

namespace tightspot::stagewise {

#if defined(__GNUC__) && defined(__AVX512F__)
constexpr int lanes = 8;
#elif defined(__GNUC__) && defined(__AVX__)
constexpr int lanes = 4;
#elif defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
constexpr int lanes = 2;
#else
constexpr int lanes = 1;
#endif

#if defined(__GNUC__)
namespace detail {
typedef double Doubles __attribute__((vector_size(8 * lanes)));
typedef std::uint64_t Integers __attribute__((vector_size(8 * lanes)));
}  // namespace detail
#endif

// Arithmetic goes lane by lane; a plain number stands for one in every lane.
struct Pack {
#if defined(__GNUC__)
    using Doubles = detail::Doubles;
    using Integers = detail::Integers;
#else
    using Doubles = double;
    using Integers = std::uint64_t;
#endif
    Doubles v;

    Pack() = default;
    Pack(double x) : v(x - Doubles{}) {}
    explicit Pack(Doubles doubles) : v(doubles) {}

#if defined(__GNUC__)
    double operator[](int lane) const { return v[lane]; }
    void set(int lane, double x) { v[lane] = x; }
#else
    double operator[](int) const { return v; }
    void set(int, double x) { v = x; }
#endif

    friend Pack operator+(Pack a, Pack b) { return Pack(a.v + b.v); }
    friend Pack operator-(Pack a, Pack b) { return Pack(a.v - b.v); }
    friend Pack operator*(Pack a, Pack b) { return Pack(a.v * b.v); }
    friend Pack operator/(Pack a, Pack b) { return Pack(a.v / b.v); }
    friend Pack operator-(Pack a) { return Pack(-a.v); }
    Pack& operator+=(Pack b) { return v += b.v, *this; }
    Pack& operator-=(Pack b) { return v -= b.v, *this; }
    Pack& operator*=(Pack b) { return v *= b.v, *this; }
};

// The larger; b if one of them is not a number.
inline double larger(double a, double b) { return a > b ? a : b; }
inline Pack larger(Pack a, Pack b) { return Pack(a.v > b.v ? a.v : b.v); }
inline double smaller(double a, double b) { return a < b ? a : b; }
inline Pack smaller(Pack a, Pack b) { return Pack(a.v < b.v ? a.v : b.v); }

// a > b ? x : y
inline double choose(double a, double b, double x, double y) { return a > b ? x : y; }
inline Pack choose(Pack a, Pack b, Pack x, Pack y) { return Pack(a.v > b.v ? x.v : y.v); }

inline double magnitude(double a) { return std::abs(a); }
inline Pack magnitude(Pack a) { return larger(a, -a); }

inline double square_root(double a) { return std::sqrt(a); }
inline Pack square_root(Pack a) {
    for (int l = 0; l < lanes; ++l) a.set(l, std::sqrt(a[l]));
    return a;
}

// Consecutive numbers from and to memory of any alignment; P is Pack or double.
template <class P>
inline P load(const double* from) {
    P p;
    std::memcpy(&p, from, sizeof p);
    return p;
}
template <class P>
inline void store(P p, double* to) {
    std::memcpy(to, &p, sizeof p);
}

// Zeros, one store after another: at these sizes the string instruction that compilers make of a loop starts too slowly.
template <std::size_t... packs, std::size_t... rest>
inline void clear(double* to, std::index_sequence<packs...>, std::index_sequence<rest...>) {
    (store(Pack(0.0), to + packs * lanes), ...);
    ((to[sizeof...(packs) * lanes + rest] = 0), ...);
}
template <std::size_t n>
inline void clear(double (&numbers)[n]) {
    clear(numbers, std::make_index_sequence<n / lanes>{}, std::make_index_sequence<n % lanes>{});
}

template <class P>
constexpr int lane_count = sizeof(P) / sizeof(double);

inline double lane(double p, int) { return p; }
inline double lane(Pack p, int l) { return p[l]; }
inline void set_lane(double& p, int, double x) { p = x; }
inline void set_lane(Pack& p, int l, double x) { p.set(l, x); }

// from[stride * index[l]] in every lane l.
template <class P>
inline P gather(const double* from, const int* index, int stride) {
    P p;
    for (int l = 0; l < lane_count<P>; ++l) set_lane(p, l, from[stride * index[l]]);
    return p;
}

// Adds lane l of the n packs to to[stride * index[l]] and the n - 1 numbers after it.
template <int n, class P>
inline void scatter_add(const P (&packs)[n], double* to, const int* index, int stride) {
    double numbers[n][lane_count<P>];
    for (int i = 0; i < n; ++i) store(packs[i], numbers[i]);
    for (int l = 0; l < lane_count<P>; ++l) {
        double* at = to + stride * index[l];
        for (int i = 0; i < n; ++i) at[i] += numbers[i][l];
    }
}

// Packs one after another in memory.
template <class P>
struct Reader {
    const double* at;

    P next() {
        const P p = load<P>(at);
        at += lane_count<P>;
        return p;
    }
};
template <class P>
struct Writer {
    double* at;

    void put(P p) {
        store(p, at);
        at += lane_count<P>;
    }
};

// Calls body(P, i): with Pack for every whole pack of n numbers, the first of which is i, then with double for each of
// the rest. P comes as a value, for its type.
template <class Body>
inline void over_packs(std::size_t n, Body&& body) {
    std::size_t i = 0;
    for (; i + lanes <= n; i += lanes) body(Pack{}, i);
    for (; i < n; ++i) body(0.0, i);
}

}  // namespace tightspot::stagewise
