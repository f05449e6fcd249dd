/*
 * Prints the seconds of one evaluation of a robot's accelerations by Pinocchio's articulated-body algorithm, in its
 * conventions WORLD and LOCAL: aba URDF fixed|floating COUNT. The arguments change from one evaluation to the next.
 */
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/parsers/urdf.hpp>

static double seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

static double time_of(const pinocchio::Model &model, pinocchio::Convention convention, long count) {
  pinocchio::Data data(model);
  const Eigen::VectorXd turned = Eigen::VectorXd::Constant(model.nv, 0.3);
  Eigen::VectorXd q = pinocchio::integrate(model, pinocchio::neutral(model), turned);
  Eigen::VectorXd v = Eigen::VectorXd::Constant(model.nv, 0.1), tau = Eigen::VectorXd::Zero(model.nv);
  const double begin = seconds();
  for (long k = 0; k < count; k++) {
    q[model.nq - 1] += 1e-9;
    v[model.nv - 1] = 0.1 + 1e-9 * pinocchio::aba(model, data, q, v, tau, convention)[0];
  }
  return (seconds() - begin) / static_cast<double>(count);
}

int main(int words, char **word) {
  if (words != 4) return 2;
  pinocchio::Model model;
  if (std::strcmp(word[2], "floating") == 0)
    pinocchio::urdf::buildModel(word[1], pinocchio::JointModelFreeFlyer(), model);
  else pinocchio::urdf::buildModel(word[1], model);
  const long count = std::atol(word[3]);
  std::printf("%g %g\n", time_of(model, pinocchio::Convention::WORLD, count),
              time_of(model, pinocchio::Convention::LOCAL, count));
  return 0;
}
