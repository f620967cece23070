// The cells of pose space that a search has reached, each with the cheapest node in it.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

#include "tightspot/pose.hpp"

namespace tightspot {

/// Cells of position, heading and gear.
struct PoseCells {
    Point origin;
    double size = 0.4;
    int heading_bins = 72;

    std::uint64_t key(const Pose& pose, int gear) const {
        const auto column = static_cast<std::uint64_t>(std::floor((pose.x - origin.x) / size) + 1.0);
        const auto row = static_cast<std::uint64_t>(std::floor((pose.y - origin.y) / size) + 1.0);
        const int turn = static_cast<int>(std::lround(wrap_angle(pose.theta) * heading_bins / (2.0 * pi)));
        const auto heading = static_cast<std::uint64_t>((turn + heading_bins) % heading_bins);
        return ((column << 40U) | (row << 16U) | (heading << 2U) | static_cast<std::uint64_t>(gear + 1)) + 1U;
    }
};

/// An open-addressing map from cell to node for a number of entries fixed beforehand. Its memory is asked for once,
/// zeroed by the system when first touched, so that a short search does not pay for the longest.
class ClosedSet {
public:
    static constexpr int absent = -1;

    explicit ClosedSet(std::size_t most_entries) {
        while (capacity_ < 2 * most_entries) capacity_ *= 2;
        slots_.reset(static_cast<Slot*>(std::calloc(capacity_, sizeof(Slot))));
        if (!slots_) throw std::bad_alloc();
    }

    /// `key` is not 0.
    int find(std::uint64_t key) const {
        const Slot& slot = slots_[locate(key)];
        return slot.key == key ? slot.node : absent;
    }

    void set(std::uint64_t key, int node) { slots_[locate(key)] = {key, node}; }

private:
    struct Slot {
        std::uint64_t key;
        int node;
    };
    struct Free {
        void operator()(Slot* slots) const { std::free(slots); }
    };

    std::size_t locate(std::uint64_t key) const {
        const std::size_t mask = capacity_ - 1;
        std::uint64_t hash = key * 0x9E3779B97F4A7C15ULL;
        hash ^= hash >> 32U;
        std::size_t slot = hash & mask;
        while (slots_[slot].key != 0 && slots_[slot].key != key) slot = (slot + 1) & mask;
        return slot;
    }

    std::size_t capacity_ = 1024;
    std::unique_ptr<Slot[], Free> slots_;
};

}  // namespace tightspot
