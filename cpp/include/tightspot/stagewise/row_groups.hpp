// Rows gathered into groups that are computed with at once: as many lines as there are lanes, a pair's or a wall's each,
// with equally many vertices and samples. What is left over comes in groups of one line.
#pragma once

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "tightspot/stagewise/problem.hpp"

namespace tightspot::stagewise {

// Row i of line l has the place row + i * width + l among all rows: a pair's obstacle side first, then the body's
// vertices sample by sample, then a soft pair's penetration. A wall has one sample and no obstacle side.
struct RowGroup {
    int part, width, corners, samples;  // corners: vertices of the obstacle part, 0 for walls
    bool soft, coupled, ends, covered;  // see RowGroups; ends: see end_lines.hpp
    int row;
    int line;      // place in RowGroups::intervals and pairs
    int sample;    // place in RowGroups::samples
    int number;    // place in RowGroups::numbers
    int geometry;  // place in Values::geometry
    int block;     // place in Assembly::blocks, for pairs

    bool wall() const { return corners == 0; }
};

// A sample pose seen from the frame of a moving obstacle part; it has its own place after all the samples' poses.
struct View {
    int interval, sample;
    const Motion* motion;
};

struct RowGroups {
    std::vector<RowGroup> walls, pairs;
    // Interval and pair (-1: a wall) of each line; of each sample's lines the place of the pose that matters to them: the
    // sample, or for a moving obstacle the number of samples plus the view's.
    Indices intervals, line_pairs, samples;
    std::vector<View> views;  // interval by interval
    Indices first_view;       // of each interval, N + 1 entries
    Indices penetrations;    // of each line, among all penetrations; -1: none
    // Packs of `width` numbers. Walls: normal inwards (x, y), its product with points on the wall. Pairs: origin (x, y),
    // constant and weight of the demand on the obstacle's side, its vertices relative to the origin (x, y). Then the
    // demand (constant, weight) of every sample.
    Vector numbers;
    Indices place;           // of each row in the problem's order (see Problem)
    Indices group, lane;     // of each pair
    Indices single, first_single;  // pairs of coupled intervals but those of groups with `ends`; N + 1 entries
    std::vector<char> coupled, covered;  // intervals whose rows depend on more than x_{k+1}, and on covers
    int geometry = 0, blocks = 0;

    // Numbers of a pair's block: three of the line's own Hessian, two mixed with the cover, six for every sample. Of a soft
    // pair five more: see SoftBlock.
    static int block_size(const RowGroup& group) {
        return group.width * (5 + 6 * group.samples + (group.soft ? soft_size : 0));
    }
    static constexpr int soft_size = 5;
};

class RowGrouping {
   public:
    RowGrouping(const Problem& problem, const Layout& layout) : problem_(problem), layout_(layout) {
        out_.place.assign(layout.rows, 0);
        out_.group.assign(problem.pairs.size(), 0), out_.lane.assign(problem.pairs.size(), 0);
        find_structure();
        collect();
        for (const auto& [kind, lines] : kinds_) split(kind, lines);
        collect_single();
    }

    RowGroups take() { return std::move(out_); }

   private:
    // A pair's, soft, coupled, ends, part, corners, samples.
    using Kind = std::tuple<bool, bool, bool, bool, int, int, int>;
    struct Line {
        int interval, index, row;  // index: of the pair or wall; row: its first in the problem's order
        int sample;                // where its samples begin in used_
    };

    void find_structure() {
        out_.coupled.assign(problem_.steps, 0), out_.covered.assign(problem_.steps, 0);
        for (int k = 0; k < problem_.steps; ++k)
            for (int p = layout_.sample[k]; p < layout_.sample[k + 1]; ++p) {
                const Demand &pair = problem_.pair_demands[p], &wall = problem_.wall_demands[p];
                const bool last = p + 1 == layout_.sample[k + 1];
                if (!last && (pair.used || wall.used)) out_.coupled[k] = 1;
                if ((pair.used && pair.weight != 0) || (wall.used && wall.weight != 0)) out_.covered[k] = 1;
            }
        for (const Pair& pair : problem_.pairs) {
            if (pair.obstacle_weight != 0) out_.covered[pair.interval] = 1;
            if (problem_.motion_of(pair.obstacle)) out_.coupled[pair.interval] = 1;
            if (pair.penalty.soft) out_.coupled[pair.interval] = 1;  // its cost depends on t_f
        }
        for (int k = 0; k < problem_.steps; ++k) out_.coupled[k] |= out_.covered[k];
    }

    // Adds an interval's samples with a demand to used_ and tells where they begin there.
    int use_samples(int k, const std::vector<Demand>& demands) {
        const int begin = static_cast<int>(used_.size());
        for (int p = layout_.sample[k]; p < layout_.sample[k + 1]; ++p)
            if (demands[p].used) used_.push_back(p);
        return begin;
    }

    // True if what was used last are the samples at both knots of an interval and no others.
    bool at_ends(int k, int begin) const {
        return used_.size() - begin == 2 && used_[begin] == layout_.sample[k] &&
               used_[begin + 1] + 1 == layout_.sample[k + 1];
    }

    // Lines by their kind, in the problem's order.
    void collect() {
        const int parts = problem_.parts.size();
        int row = 0;
        for (int k = 0; k < problem_.steps; ++k) {
            const int wall_begin = use_samples(k, problem_.wall_demands);
            const int pair_begin = use_samples(k, problem_.pair_demands);
            const int samples = static_cast<int>(used_.size()) - pair_begin;
            const bool both_ends = at_ends(k, pair_begin);
            const bool coupled = out_.coupled[k] != 0;
            out_.first_view.push_back(static_cast<int>(out_.views.size()));
            for (int part = 0; part < parts; ++part) {
                const int at = k * parts + part, count = problem_.parts.count(part);
                for (int sample = wall_begin; sample < pair_begin; ++sample)
                    for (int i = layout_.wall[at]; i < layout_.wall[at + 1]; ++i, row += count)
                        kinds_[{false, false, coupled, false, part, 0, 1}].push_back({k, i, row, sample});
                for (int i = layout_.pair[at]; i < layout_.pair[at + 1]; ++i) {
                    const int corners = problem_.obstacles.count(problem_.pairs[i].obstacle);
                    const bool soft = layout_.soft[i] >= 0;
                    const Motion* motion = problem_.motion_of(problem_.pairs[i].obstacle);
                    const bool ends = !soft && !motion && both_ends;
                    kinds_[{true, soft, coupled, ends, part, corners, samples}].push_back({k, i, row, pair_begin});
                    row += corners + samples * count + (soft ? 1 : 0);
                    if (motion)
                        for (int s = 0; s < samples; ++s) add_view({k, used_[pair_begin + s], motion});
                }
            }
        }
        out_.first_view.push_back(static_cast<int>(out_.views.size()));
    }

    void add_view(const View& view) {
        if (view_of_.try_emplace({view.motion, view.sample}, static_cast<int>(out_.views.size())).second)
            out_.views.push_back(view);
    }

    void collect_single() {
        const int parts = problem_.parts.size();
        for (int k = 0; k < problem_.steps; ++k) {
            out_.first_single.push_back(static_cast<int>(out_.single.size()));
            for (int i = layout_.pair[k * parts]; out_.coupled[k] && i < layout_.pair[(k + 1) * parts]; ++i)
                if (!out_.pairs[out_.group[i]].ends) out_.single.push_back(i);
        }
        out_.first_single.push_back(static_cast<int>(out_.single.size()));
    }

    // Where the pose is that matters to a line at a sample.
    int pose_of(bool is_pair, const Line& line, int sample) const {
        const Motion* motion = is_pair ? problem_.motion_of(problem_.pairs[line.index].obstacle) : nullptr;
        return motion ? layout_.sample.back() + view_of_.at({motion, sample}) : sample;
    }

    void split(const Kind& kind, const std::vector<Line>& lines) {
        const int count = static_cast<int>(lines.size());
        int first = 0;
        for (; first + lanes <= count; first += lanes) add(kind, lines.data() + first, lanes);
        for (; first < count; ++first) add(kind, lines.data() + first, 1);
    }

    void add(const Kind& kind, const Line* lines, int width) {
        const auto [is_pair, soft, coupled, ends, part, corners, samples] = kind;
        RowGroup group{part, width, corners, samples, soft, coupled, ends, false, row_, 0, 0, 0, out_.geometry, out_.blocks};
        group.line = static_cast<int>(out_.intervals.size());
        group.sample = static_cast<int>(out_.samples.size());
        group.number = static_cast<int>(out_.numbers.size());
        out_.numbers.resize(out_.numbers.size() + width * ((is_pair ? 4 + 2 * corners : 3) + 2 * samples));
        next_ = out_.numbers.data() + group.number;
        const int rows = corners + samples * problem_.parts.count(part) + (soft ? 1 : 0);
        for (int l = 0; l < width; ++l) {
            out_.intervals.push_back(lines[l].interval), out_.line_pairs.push_back(is_pair ? lines[l].index : -1);
            out_.penetrations.push_back(is_pair ? layout_.soft[lines[l].index] : -1);
            group.covered |= out_.covered[lines[l].interval] != 0;
            for (int i = 0; i < rows; ++i) out_.place[lines[l].row + i] = row_ + i * width + l;
            if (!is_pair) continue;
            out_.group[lines[l].index] = static_cast<int>(out_.pairs.size()), out_.lane[lines[l].index] = l;
        }
        for (int s = 0; s < samples; ++s)
            for (int l = 0; l < width; ++l) out_.samples.push_back(pose_of(is_pair, lines[l], used_[lines[l].sample + s]));
        if (is_pair)
            add_pair_numbers(lines, width, corners);
        else
            add_wall_numbers(lines, width);
        const std::vector<Demand>& demands = is_pair ? problem_.pair_demands : problem_.wall_demands;
        for (int s = 0; s < samples; ++s) {
            add_numbers(width, [&](int l) {
                return demands[used_[lines[l].sample + s]].constant + (is_pair ? problem_.pairs[lines[l].index].extra : 0);
            });
            add_numbers(width, [&](int l) { return demands[used_[lines[l].sample + s]].weight; });
        }
        row_ += rows * width;
        out_.geometry += width * (2 + 4 * samples);
        if (is_pair) out_.blocks += RowGroups::block_size(group);
        (is_pair ? out_.pairs : out_.walls).push_back(group);
    }

    template <class Number>
    void add_numbers(int width, Number&& number) {
        for (int l = 0; l < width; ++l) *next_++ = number(l);
    }

    void add_wall_numbers(const Line* lines, int width) {
        const auto wall = [&](int l) -> const Wall& { return problem_.walls[lines[l].index]; };
        add_numbers(width, [&](int l) { return -wall(l).normal[0]; });
        add_numbers(width, [&](int l) { return -wall(l).normal[1]; });
        add_numbers(width, [&](int l) { return -wall(l).offset; });
    }

    void add_pair_numbers(const Line* lines, int width, int corners) {
        const auto pair = [&](int l) -> const Pair& { return problem_.pairs[lines[l].index]; };
        const auto vertex = [&](int l, int j) { return problem_.obstacles.first[pair(l).obstacle] + j; };
        add_numbers(width, [&](int l) { return pair(l).origin[0]; });
        add_numbers(width, [&](int l) { return pair(l).origin[1]; });
        add_numbers(width, [&](int l) { return pair(l).obstacle_side; });
        add_numbers(width, [&](int l) { return pair(l).obstacle_weight; });
        for (int j = 0; j < corners; ++j) {
            add_numbers(width, [&](int l) { return problem_.obstacles.x[vertex(l, j)] - pair(l).origin[0]; });
            add_numbers(width, [&](int l) { return problem_.obstacles.y[vertex(l, j)] - pair(l).origin[1]; });
        }
    }

    const Problem& problem_;
    const Layout& layout_;
    RowGroups out_;
    std::map<Kind, std::vector<Line>> kinds_;
    Indices used_;  // of each interval the samples with a demand for walls, then those with one for pairs
    std::map<std::pair<const Motion*, int>, int> view_of_;  // by motion and sample
    double* next_ = nullptr;  // where the group's next number goes in out_.numbers
    int row_ = 0;
};

// Calls body(P, group) with Pack for groups as wide as a pack and with double for the others.
template <class Body>
inline void over_groups(const std::vector<RowGroup>& groups, Body&& body) {
    for (const RowGroup& group : groups) {
        if (group.width == lanes)
            body(Pack{}, group);
        else
            body(0.0, group);
    }
}

}  // namespace tightspot::stagewise
