// The filter of Waechter and Biegler (2006): pairs (violation, barrier objective) that a trial point must not be
// dominated by.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace tightspot::stagewise {

struct Merit {
    double violation, barrier;  // 1-norm of the constraints' violation; barrier objective
};

class Filter {
   public:
    explicit Filter(int most) { entries_.reserve(most); }

    void clear() { entries_.clear(); }

    bool admits(const Merit& trial) const {
        for (const Merit& entry : entries_)
            if (!(trial.violation < entry.violation || trial.barrier < entry.barrier)) return false;
        return true;
    }

    // Forgets entries that the new one dominates; when full, the oldest.
    void add(const Merit& at) {
        const Merit entry{(1 - 1e-5) * at.violation, at.barrier - 1e-8 * at.violation};
        entries_.erase(std::remove_if(entries_.begin(), entries_.end(),
                                      [&](const Merit& old) {
                                          return old.violation >= entry.violation && old.barrier >= entry.barrier;
                                      }),
                       entries_.end());
        if (entries_.size() == entries_.capacity()) entries_.erase(entries_.begin());
        entries_.push_back(entry);
    }

   private:
    std::vector<Merit> entries_;
};

// Is the trial point good enough after a step of length alpha along a direction with the barrier objective's slope?
struct Acceptance {
    bool accepted, augments;  // augments: the filter takes the point that is left
};

inline Acceptance accept(const Filter& filter, const Merit& from, const Merit& trial, double slope, double alpha,
                         double small_violation, double large_violation) {
    if (!(trial.violation < large_violation) || !std::isfinite(trial.barrier) || !filter.admits(trial))
        return {false, false};
    const double rounding = 10 * 2.2e-16 * std::abs(from.barrier);
    const bool descends = slope < 0 && alpha * std::pow(-slope, 2.3) > std::pow(from.violation, 1.1);
    if (from.violation <= small_violation && descends)
        return {trial.barrier <= from.barrier + 1e-8 * alpha * slope + rounding, false};
    const bool better = trial.violation <= (1 - 1e-5) * from.violation ||
                        trial.barrier <= from.barrier - 1e-8 * from.violation + rounding;
    return {better, true};
}

}  // namespace tightspot::stagewise
