// Sizes of one stage, known at compile time, and the small dense kernels that use them.
#pragma once

#include <cmath>

namespace tightspot::stagewise {

// Orders of variables: a = (x_k, t_f, u_k), z = (x_k, t_f), w = (x_k, t_f, u_k, x_{k+1}).
// No model's dynamics depend on the position, the first two states; `inner` is a without them.
template <class Model>
struct Sizes {
    static constexpr int nx = Model::states, nu = Model::inputs;
    static constexpr int nz = nx + 1, na = nz + nu, nw = na + nx, inner = na - 2;
};

template <int rows, int columns>
using Block = double[rows * columns];

// Symmetric positive definite solve in place, n at most `size`; false if a pivot is not clearly positive.
template <int size>
bool cholesky(double* a, int n, double smallest) {
    for (int j = 0; j < n; ++j) {
        double pivot = a[j * size + j];
        for (int i = 0; i < j; ++i) pivot -= a[j * size + i] * a[j * size + i];
        if (!(pivot > smallest)) return false;
        const double root = std::sqrt(pivot);
        a[j * size + j] = root;
        for (int r = j + 1; r < n; ++r) {
            double sum = a[r * size + j];
            for (int i = 0; i < j; ++i) sum -= a[r * size + i] * a[j * size + i];
            a[r * size + j] = sum / root;
        }
    }
    return true;
}

template <int size>
void cholesky_solve(const double* l, int n, double* b) {
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < i; ++j) b[i] -= l[i * size + j] * b[j];
        b[i] /= l[i * size + i];
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int j = i + 1; j < n; ++j) b[i] -= l[j * size + i] * b[j];
        b[i] /= l[i * size + i];
    }
}

}  // namespace tightspot::stagewise
