#include <cmath>
#include <random>
#include <vector>

#include "check.hpp"
#include "tightspot/stagewise/line_fit.hpp"

using tightspot::stagewise::LineFit;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Corner {
    double x, y, demand;
};

// The corners of a rectangle about (x, y), turned by an angle.
std::vector<Corner> rectangle(double x, double y, double length, double width, double angle, double demand) {
    std::vector<Corner> corners;
    for (const auto& [a, b] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
        const double along = 0.5 * a * length, across = 0.5 * b * width;
        corners.push_back({x + along * std::cos(angle) - across * std::sin(angle),
                           y + along * std::sin(angle) + across * std::cos(angle), demand});
    }
    return corners;
}

struct Pair {
    std::vector<Corner> obstacle, body;

    // Sum of the logarithms of all rows; minus infinity if one of them has no room.
    double room(double phi, double mu) const {
        double sum = 0;
        for (const auto* side : {&obstacle, &body})
            for (const Corner& corner : *side) {
                const double along = std::cos(phi) * corner.x + std::sin(phi) * corner.y - mu;
                const double row = (side == &obstacle ? -along : along) - corner.demand;
                sum += row > 0 ? std::log(row) : -HUGE_VAL;
            }
        return sum;
    }
    bool fit(double from, LineFit& line) const {
        line.clear();
        for (const Corner& corner : obstacle) line.add_obstacle(corner.x, corner.y, corner.demand);
        for (const Corner& corner : body) line.add_body(corner.x, corner.y, corner.demand);
        return line.fit(from);
    }
};

}  // namespace

TEST(a_fitted_line_has_nearly_the_most_room) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1, 1);
    LineFit line;
    for (int round = 0; round < 200; ++round) {
        const double way = pi * number(random), distance = 5 + 2 * number(random);
        const Pair pair{rectangle(0, 0, 3 + number(random), 2, pi * number(random), 0.05),
                        rectangle(distance * std::cos(way), distance * std::sin(way), 4, 1.8, pi * number(random), 0.1)};
        double most = -HUGE_VAL;
        for (int i = 0; i < 360; ++i)
            for (int j = 0; j <= 100; ++j) most = std::max(most, pair.room(i * pi / 180, -2 + 0.1 * j));
        const bool found = pair.fit(pi * number(random), line);
        if (std::isfinite(most)) CHECK(found);
        if (!found) continue;
        const double room = pair.room(line.phi, line.mu);
        CHECK(std::isfinite(room));
        CHECK(room > most - 0.1);
    }
}

TEST(a_symmetric_fit_is_exact) {
    LineFit line;
    const Pair pair{rectangle(-2, 0, 2, 2, 0, 0), rectangle(2, 0, 2, 2, 0, 0)};
    CHECK(pair.fit(2.5, line));
    CHECK_CLOSE(std::remainder(line.phi, 2 * pi), 0.0, 0.05);
    CHECK_CLOSE(line.mu, 0.0, 0.05);
}

TEST(no_line_is_fitted_where_there_is_none) {
    LineFit line;
    const std::vector<Corner> box = rectangle(0, 0, 2, 2, 0, 0);
    CHECK(!(Pair{box, rectangle(1.5, 0.3, 2, 2, 0.3, 0)}.fit(0, line)));
    CHECK(!(Pair{box, rectangle(2.5, 0, 2, 2, 0, 0.6)}.fit(0, line)));
    CHECK(!(Pair{box, box}.fit(1, line)));
    CHECK(!(Pair{box, {{std::nan(""), 3, 0}}}.fit(1, line)));
    CHECK(!(Pair{box, rectangle(4, 0, 2, 2, 0, 0)}.fit(std::nan(""), line)));
}
