#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace crease {

/// One of ITK's transforms: its class, such as "AffineTransform_double_3_3", and the two lists of numbers
/// that define it.
struct ItkTransform {
  std::string name;
  Eigen::VectorXd fixed_parameters, parameters;
};

/// What a file of ITK holds, in the file's order.
struct ItkTransformList {
  std::filesystem::path file;
  std::string format;  ///< "ITK text", "ITK HDF5" or "ITK Matlab"
  std::vector<ItkTransform> transforms;
};

}  // namespace crease
