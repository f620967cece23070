// A test harness of a few lines: TEST cases register themselves, CHECK counts, main (in main.cpp) reports.
#pragma once

#include <cmath>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace check {

struct Case {
    std::string name;
    std::function<void()> body;
};

inline std::vector<Case>& cases() {
    static std::vector<Case> all;
    return all;
}

struct Registration {
    Registration(const char* name, std::function<void()> body) { cases().push_back({name, std::move(body)}); }
};

inline int& checks() {
    static int count = 0;
    return count;
}

inline int& failures() {
    static int count = 0;
    return count;
}

inline void that(bool holds, const char* text, const char* file, int line) {
    ++checks();
    if (holds) return;
    ++failures();
    std::cerr << file << ":" << line << ": " << text << "\n";
}

inline void close(double value, double wanted, double tolerance, const char* text, const char* file, int line) {
    ++checks();
    if (std::abs(value - wanted) <= tolerance) return;
    ++failures();
    std::cerr << file << ":" << line << ": " << text << ": " << value << " is not " << wanted << " within " << tolerance
              << "\n";
}

}  // namespace check

#define TEST(name)                                                          \
    static void test_##name();                                              \
    static const check::Registration registered_##name(#name, test_##name); \
    static void test_##name()
#define CHECK(condition) check::that((condition), #condition, __FILE__, __LINE__)
#define CHECK_CLOSE(value, wanted, tolerance) check::close((value), (wanted), (tolerance), #value, __FILE__, __LINE__)
