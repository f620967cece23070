// The vehicle's body: convex parts fixed to the rear-axle frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tightspot/polygon.hpp"

namespace tightspot {

struct Footprint {
    std::vector<Polygon> parts;
    Point centre;                  ///< of the circle around the body, in the body frame
    double radius = 0.0;           ///< of that circle
    double inscribed = -HUGE_VAL;  ///< radius of a disc about the rear-axle midpoint in the body, negative if none
    double narrowest = 0.0;        ///< shorter side of the body's bounding box

    explicit Footprint(std::vector<Polygon> convex_parts) : parts(std::move(convex_parts)) {
        if (parts.empty()) throw std::invalid_argument("a body needs at least one part");
        Point low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
        for (const Polygon& part : parts) {
            for (const Point& v : part.vertices) {
                low = {std::min(low.x, v.x), std::min(low.y, v.y)};
                high = {std::max(high.x, v.x), std::max(high.y, v.y)};
            }
            inscribed = std::max(inscribed, *std::min_element(part.offsets.begin(), part.offsets.end()));
        }
        centre = {0.5 * (low.x + high.x), 0.5 * (low.y + high.y)};
        narrowest = std::min(high.x - low.x, high.y - low.y);
        for (const Polygon& part : parts)
            for (const Point& v : part.vertices) radius = std::max(radius, std::hypot(v.x - centre.x, v.y - centre.y));
    }

    /// The longest way any body point covers while the rear-axle midpoint covers 1 m at this curvature.
    double sweep_rate(double curvature) const {
        double square = 0.0;
        for (const Polygon& part : parts) {
            for (const Point& v : part.vertices) {
                const double along = 1.0 - curvature * v.y, across = curvature * v.x;
                square = std::max(square, along * along + across * across);
            }
        }
        return std::max(1.0, std::sqrt(square));
    }
};

}  // namespace tightspot
