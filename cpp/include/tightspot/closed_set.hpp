// The cells of pose space that a search has reached, each with the cheapest node in it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tightspot/pose.hpp"

namespace tightspot {

/// Cells of position, heading and gear.
struct PoseCells {
    Point origin;
    double size = 0.4;
    int heading_bins = 72;  ///< at most `most_heading_bins`
    static constexpr int most_heading_bins = 1 << 13;

    /// `is_apart`: a second cell of its own at the same place.
    std::uint64_t key(const Pose& pose, int gear, bool is_apart) const {
        const std::int64_t turn = floored(pose.theta * heading_bins / (2.0 * pi) + 0.5);
        const std::int64_t heading = turn % heading_bins + (turn % heading_bins < 0 ? heading_bins : 0);
        return (number(pose.x - origin.x) << 40U | number(pose.y - origin.y) << 16U |
                static_cast<std::uint64_t>(is_apart) << 15U | static_cast<std::uint64_t>(heading) << 2U |
                static_cast<std::uint64_t>(gear + 1)) +
               1U;
    }

private:
    /// A column or row as 24 bits; just outside of the workspace, too.
    std::uint64_t number(double distance) const {
        return static_cast<std::uint64_t>(floored(distance / size) + 1) & 0xFFFFFFU;
    }

    /// The largest whole number that is not above. std::floor would be a call unless compiled for newer processors.
    static std::int64_t floored(double value) {
        const auto whole = static_cast<std::int64_t>(value);
        return whole - static_cast<std::int64_t>(value < static_cast<double>(whole));
    }
};

/// An open-addressing map from cell to node. It doubles when half full, so that a search pays for what it reaches.
class ClosedSet {
public:
    static constexpr int absent = -1;

    explicit ClosedSet(std::size_t expected_entries) {
        std::size_t capacity = 1024;
        while (capacity < 2 * expected_entries) capacity *= 2;
        slots_.resize(capacity);
    }

    /// `key` is not 0.
    int find(std::uint64_t key) const {
        const Slot& slot = slots_[locate(slots_, key)];
        return slot.key == key ? slot.node : absent;
    }

    void set(std::uint64_t key, int node) {
        Slot* slot = &slots_[locate(slots_, key)];
        if (slot->key == 0) {
            if (2 * ++entries_ > slots_.size()) {
                grow();
                slot = &slots_[locate(slots_, key)];
            }
        }
        *slot = {key, node};
    }

private:
    struct Slot {
        std::uint64_t key = 0;
        int node = absent;
    };

    static std::size_t locate(const std::vector<Slot>& slots, std::uint64_t key) {
        const std::size_t mask = slots.size() - 1;
        std::uint64_t hash = key * 0x9E3779B97F4A7C15ULL;
        hash ^= hash >> 32U;
        std::size_t slot = hash & mask;
        while (slots[slot].key != 0 && slots[slot].key != key) slot = (slot + 1) & mask;
        return slot;
    }

    void grow() {
        std::vector<Slot> larger(2 * slots_.size());
        for (const Slot& slot : slots_)
            if (slot.key != 0) larger[locate(larger, slot.key)] = slot;
        slots_.swap(larger);
    }

    std::vector<Slot> slots_;
    std::size_t entries_ = 0;
};

}  // namespace tightspot
