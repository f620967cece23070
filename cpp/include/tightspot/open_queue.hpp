// What a best-first search has still to look at, the most promising first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace tightspot {

/// A node to expand, or a move from a node that was not looked at yet.
struct OpenEntry {
    static constexpr int no_move = -1;
    double total;  ///< cost up to here and weighted estimate of the cost left
    int node;
    int move;

    bool is_move() const { return move != no_move; }

    /// Ties are broken by age, so that searches are deterministic.
    bool operator>(const OpenEntry& other) const {
        if (total != other.total) return total > other.total;
        return node != other.node ? node > other.node : move > other.move;
    }
};

/// A binary heap whose entries may be revalued all at once.
class OpenQueue {
public:
    bool is_empty() const { return heap_.empty(); }
    double least_total() const { return heap_.front().total; }

    void push(const OpenEntry& entry) {
        heap_.push_back(entry);
        std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
    }

    OpenEntry pop() {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
        const OpenEntry entry = heap_.back();
        heap_.pop_back();
        return entry;
    }

    /// Gives every entry the total `value(entry)`.
    template <class Value>
    void revalue(Value&& value) {
        for (OpenEntry& entry : heap_) entry.total = value(entry);
        std::make_heap(heap_.begin(), heap_.end(), std::greater<>());
    }

private:
    std::vector<OpenEntry> heap_;
};

}  // namespace tightspot
