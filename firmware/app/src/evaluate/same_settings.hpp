// Which settings and numbers lead to the same results.
#pragma once

#include <cstddef>

#include "emax/app/settings/settings.hpp"

namespace emax::app {

/// Whether the random numbers are the same ones.
bool is_same_generator(const Settings& a, const Settings& b) noexcept;

/// Whether the trials are the same, for the same device.
bool is_same_trials(const Settings& a, const Settings& b) noexcept;

/// Whether the times of the trend are the same.
bool is_same_trend(const Settings& a, const Settings& b) noexcept;

/// Whether model, limit and energy are the same.
bool is_same_energy(const Settings& a, const Settings& b) noexcept;

/// Whether so many bytes are the same.
bool is_same_memory(const void* a, const void* b, std::size_t bytes) noexcept;

}  // namespace emax::app
