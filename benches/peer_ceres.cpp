// Times Ceres Solver on the triplets that `cargo bench --bench path` left behind: method D with analytic derivatives, from the
// same good prior as the other peers, one thread, normal equations (its fastest way for eight unknowns).
//
// A line for each number: triplets wanted, name, milliseconds (median of several). `benches/table` builds and runs it.

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

using Point = std::array<double, 3>;
using Triplet = std::array<Point, 3>;

// A point in frame 1, and its derivative by yaw.
static void place(const Point &q, const double *t, Point &p, Point &turned) {
  const double c = std::cos(t[3]), s = std::sin(t[3]);
  const double x = c * q[0] - s * q[1], y = s * q[0] + c * q[1];
  p = {x + t[0], y + t[1], q[2] + t[2]};
  turned = {-y, x, 0.0};
}

// The three distance errors of a triplet; unknowns are x, y, z and yaw of stations 2 and 3.
class DistanceErrors : public ceres::SizedCostFunction<3, 4, 4> {
 public:
  DistanceErrors(const Triplet &triplet, const std::array<double, 3> &distances)
      : triplet_(triplet), distances_(distances) {}

  bool Evaluate(double const *const *unknowns, double *errors, double **jacobians) const override {
    Point p2, p3, turned2, turned3;
    place(triplet_[1], unknowns[0], p2, turned2);
    place(triplet_[2], unknowns[1], p3, turned3);
    const Point &p1 = triplet_[0];
    const Point none = {0.0, 0.0, 0.0};
    double *by2 = jacobians ? jacobians[0] : nullptr, *by3 = jacobians ? jacobians[1] : nullptr;
    pair(0, p1, none, nullptr, p2, turned2, by2, errors);
    pair(1, p1, none, nullptr, p3, turned3, by3, errors);
    pair(2, p2, turned2, by2, p3, turned3, by3, errors);
    if (by2) std::fill(by2 + 4, by2 + 8, 0.0);
    if (by3) std::fill(by3, by3 + 4, 0.0);
    return true;
  }

 private:
  void pair(int row, const Point &a, const Point &turned_a, double *by_a, const Point &b, const Point &turned_b,
            double *by_b, double *errors) const {
    const Point e = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    const double length = std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    errors[row] = length - distances_[row];
    const auto derivative = [&](double *by, const Point &turned, double sign) {
      if (!by) return;
      double *at = by + 4 * row;
      at[3] = 0.0;
      for (int k = 0; k < 3; ++k) {
        at[k] = sign * e[k] / length;
        at[3] += at[k] * turned[k];
      }
    };
    derivative(by_a, turned_a, 1.0);
    derivative(by_b, turned_b, -1.0);
  }

  Triplet triplet_;
  std::array<double, 3> distances_;
};

static std::vector<std::vector<double>> rows(const std::string &path, bool header) {
  std::ifstream file(path);
  std::string line;
  std::vector<std::vector<double>> rows;
  if (header) std::getline(file, line);
  while (std::getline(file, line)) {
    std::stringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::atof(cell.c_str()));
    rows.push_back(row);
  }
  if (rows.empty()) {
    std::fprintf(stderr, "%s: nothing in it; run cargo bench --bench path first\n", path.c_str());
    std::exit(1);
  }
  return rows;
}

int main(int count, char **arguments) {
  const std::string folder = count > 1 ? arguments[1] : "target/bench-triplets";
  for (const char *size : {"2000", "20000", "200000", "2000000"}) {
    std::vector<Triplet> triplets;
    for (const auto &row : rows(folder + "/" + size + "/triplets.csv", true)) {
      Triplet triplet;
      for (int station = 0; station < 3; ++station)
        for (int k = 0; k < 3; ++k) triplet[station][k] = row[2 + 3 * station + k];
      triplets.push_back(triplet);
    }
    // Distances, prior, our answer.
    const auto told = rows(folder + "/" + size + "/problem.csv", false);
    const std::array<double, 3> distances = {told[0][0], told[0][1], told[0][2]};
    std::vector<double> set_up_ms, solve_ms;
    for (int repeat = 0; repeat < (triplets.size() < 100000 ? 9 : 3); ++repeat) {
      std::vector<double> unknowns = told[1];
      const auto start = std::chrono::steady_clock::now();
      ceres::Problem problem;
      for (const auto &triplet : triplets)
        problem.AddResidualBlock(new DistanceErrors(triplet, distances), nullptr, &unknowns[0], &unknowns[4]);
      const auto ready = std::chrono::steady_clock::now();
      ceres::Solver::Options options;
      options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
      options.num_threads = 1;
      options.logging_type = ceres::SILENT;
      // By default it may stop 13 µm short.
      options.function_tolerance = 1e-8;
      ceres::Solver::Summary summary;
      ceres::Solve(options, &problem, &summary);
      const auto solved = std::chrono::steady_clock::now();
      const auto ms = [](auto from, auto to) { return std::chrono::duration<double, std::milli>(to - from).count(); };
      set_up_ms.push_back(ms(start, ready));
      solve_ms.push_back(ms(ready, solved));
      for (int k = 0; k < 8; ++k)
        if (std::abs(unknowns[k] - told[2][k]) > 1e-5) {
          std::fprintf(stderr, "Ceres and resect disagree by %g at %s triplets\n", unknowns[k] - told[2][k], size);
          return 1;
        }
    }
    const auto median = [](std::vector<double> &list) {
      std::sort(list.begin(), list.end());
      return list[list.size() / 2];
    };
    std::printf("%s ceres-set-up %.3f\n%s ceres %.3f\n", size, median(set_up_ms), size, median(solve_ms));
  }
}
