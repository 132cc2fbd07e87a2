// Which devices can be given by their parameters.
#pragma once

#include "emax/app/evaluate/evaluation.hpp"

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// Checks that a device and everything within its uncertainties is of the kind that is supported.
///
/// @returns The problem of the option --model, if there is one, with what is supported and why.
Problem check_model(const app::Device& device);

}  // namespace emax::desk
