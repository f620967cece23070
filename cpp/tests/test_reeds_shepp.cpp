#include <random>

#include "check.hpp"
#include "tightspot/reeds_shepp.hpp"

using namespace tightspot;

namespace {

double defect(const Pose& start, const Pose& goal, const Word& word, double radius) {
    Pose pose = start;
    for (int i = 0; i < word.size; ++i) pose = advance(pose, word.arc(i, radius));
    return std::abs(pose.x - goal.x) + std::abs(pose.y - goal.y) + std::abs(wrap_angle(pose.theta - goal.theta));
}

}  // namespace

TEST(every_word_ends_at_the_goal) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 3000; ++i) {
        const double scale = i % 3 == 0 ? 1.0 : i % 3 == 1 ? 5.0 : 40.0;
        const double radius = 0.5 + 4.0 * std::abs(unit(random));
        const Pose start{scale * unit(random), scale * unit(random), 7 * unit(random)};
        const Pose goal{scale * unit(random), scale * unit(random), 7 * unit(random)};
        const std::vector<Word> words = reeds_shepp::all(start, goal, radius);
        CHECK(!words.empty());
        for (const Word& word : words) CHECK(defect(start, goal, word, radius) < 1e-7);
        for (std::size_t k = 1; k < words.size(); ++k) CHECK(words[k - 1].length() <= words[k].length());
        CHECK_CLOSE(words.front().length(), reeds_shepp::shortest(start, goal, radius).length(), 1e-9);
    }
}

TEST(the_length_is_a_metric) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto length = [](const Pose& a, const Pose& b) { return reeds_shepp::shortest(a, b, 1.0).length(); };
    for (int i = 0; i < 2000; ++i) {
        Pose p[3];
        for (Pose& pose : p) pose = {4 * unit(random), 4 * unit(random), 3 * unit(random)};
        CHECK_CLOSE(length(p[0], p[1]), length(p[1], p[0]), 1e-9);
        CHECK(length(p[0], p[2]) <= length(p[0], p[1]) + length(p[1], p[2]) + 1e-9);
        CHECK(length(p[0], p[1]) >= std::hypot(p[0].x - p[1].x, p[0].y - p[1].y) - 1e-12);
    }
}

TEST(words_with_zero_lengths_are_found) {
    CHECK(reeds_shepp::shortest({1, 2, 3}, {1, 2, 3}, 2.0).size == 0);
    CHECK(reeds_shepp::shortest({1, 2, 3}, {1, 2, 3 + 2 * pi}, 2.0).size == 0);
    const Word ahead = reeds_shepp::shortest({0, 0, 0}, {5, 0, 0}, 2.0);
    CHECK(ahead.size == 1 && ahead.turns[0] == Turn::straight);
    CHECK_CLOSE(ahead.lengths[0] * 2.0, 5.0, 1e-12);
    const Word behind = reeds_shepp::shortest({0, 0, 0}, {-5, 0, 0}, 2.0);
    CHECK(behind.size == 1 && behind.lengths[0] < 0.0);
    for (const Arc arc : {Arc{1.0, 0.5}, Arc{-1.0, 0.5}, Arc{2.5, -0.5}, Arc{-3.0, -0.5}}) {
        const Word word = reeds_shepp::shortest({0, 0, 0}, advance({0, 0, 0}, arc), 2.0);
        CHECK(word.size == 1);
        CHECK_CLOSE(word.length() * 2.0, std::abs(arc.length), 1e-9);
    }
}

TEST(nearly_degenerate_goals_are_reached) {
    for (const double eps : {1e-15, 1e-12, 1e-10, 1e-9, 1e-7, 1e-5}) {
        for (const Pose goal :
             {Pose{eps, 0, 0}, Pose{0, eps, 0}, Pose{0, 0, eps}, Pose{3, eps, -eps}, Pose{-3, -eps, eps},
              Pose{0, 2, pi - eps}, Pose{0, 0, pi - eps}, Pose{2, 0, -pi + eps}, Pose{0, -4, eps}}) {
            const Word word = reeds_shepp::shortest({0, 0, 0}, goal, 1.0);
            CHECK(defect({0, 0, 0}, goal, word, 1.0) < 1e-7);
            CHECK(std::isfinite(word.length()));
        }
    }
}

TEST(no_random_drive_of_full_locks_beats_the_shortest_word) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 20000; ++i) {
        Pose pose{0, 0, 0};
        double length = 0.0;
        for (int k = 0; k < 4; ++k) {
            const Arc arc{2.0 * unit(random), static_cast<double>(static_cast<int>(random() % 3) - 1)};
            pose = advance(pose, arc);
            length += std::abs(arc.length);
        }
        CHECK(reeds_shepp::shortest({0, 0, 0}, pose, 1.0).length() <= length + 1e-9);
    }
}
