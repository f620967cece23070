// What a planning problem demands at each sample, and of which pairs and walls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tightspot::stagewise {

// Clearances, m; whether the start's and the goal's pose are given.
struct Clearances {
    double margin, end_margin, workspace_margin;
    bool start_given, goal_given;
};

// Demands (constant, weight of the cover): of pairs by sample, the obstacle's side by interval, walls by sample.
//
// The clearance d at a sample is the margin plus the cover; where the pose is given it is the end margin alone. Half the
// first sample's clearance lies on the obstacle's side of the line, d less that half on the body's. Intervals that are
// not whole have rows at their last sample only, without a cover.
struct Demanded {
    std::vector<double> pairs, sides, walls;

    Demanded(const std::vector<std::int64_t>& pieces, const std::vector<char>& whole, const Clearances& wanted) {
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        const auto write = [](double* to, double constant, double weight) { to[0] = constant, to[1] = weight; };
        std::size_t samples = 0;
        for (std::int64_t count : pieces) samples += static_cast<std::size_t>(count) + 1;
        pairs.assign(2 * samples, 0), walls.assign(2 * samples, 0), sides.assign(2 * pieces.size(), 0);
        std::size_t sample = 0;
        for (std::size_t k = 0; k < pieces.size(); ++k)
            for (std::int64_t piece = 0; piece <= pieces[k]; ++piece, ++sample) {
                write(&pairs[2 * sample], wanted.margin, whole[k]);
                write(&walls[2 * sample], wanted.workspace_margin, whole[k]);
            }
        if (wanted.start_given) write(&pairs[0], wanted.end_margin, 0), write(&walls[0], none, none);
        if (wanted.goal_given)
            write(&pairs[2 * samples - 2], wanted.end_margin, 0), write(&walls[2 * samples - 2], 0, 0);
        std::size_t first = 0;
        for (std::size_t k = 0; k < pieces.size(); ++k) {
            const std::size_t last = first + static_cast<std::size_t>(pieces[k]), shared = whole[k] ? first : last;
            for (std::size_t i = 0; i < 2; ++i) sides[2 * k + i] = pairs[2 * shared + i] / 2;
            for (std::size_t s = first; s <= last; ++s)
                for (std::size_t i = 0; i < 2; ++i) pairs[2 * s + i] -= sides[2 * k + i];
            if (!whole[k]) write(&pairs[2 * first], none, none), write(&walls[2 * first], none, none);
            first = last + 1;
        }
    }
};

}  // namespace tightspot::stagewise
