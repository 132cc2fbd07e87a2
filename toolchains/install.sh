#!/bin/sh
# Installs with apt-get what a fresh Debian 12 lacks to build emax, or to test it.
set -eu

usage() {
  cat <<'TEXT'
usage: toolchains/install.sh [host | web | arm | target]

  host     what builds and runs the program on this PC: 0.1 GB to download, 0.4 GB installed
  web      what builds the page emax.html, which a browser runs
  arm      what builds and checks the firmware of a board with an Arm core, to flash it: 0.5 GB to download, 2.6 GB
           installed
  target   what host installs, and what builds the firmware and runs it in an emulator: 0.8 GB, 4.5 GB installed
  none     that, and everything the tests of all configurations need: 1 GB, 5.5 GB installed

Installs only what is missing; with nothing missing it needs neither root nor a network.
TEXT
}

build_packages='cmake g++ gnuplot-nox ninja-build'
target_packages="gcc-arm-none-eabi gcc-riscv64-unknown-elf googletest libnewlib-arm-none-eabi \
libstdc++-arm-none-eabi-newlib picolibc-riscv64-unknown-elf python3 python3-mpmath python3-numpy qemu-system-arm qemu-system-misc"
arm_packages="cmake gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib ninja-build python3 python3-numpy"
web_packages="clang cmake gcc-arm-none-eabi libnewlib-dev libstdc++-arm-none-eabi-newlib lld ninja-build python3"
check_packages="chromium clang clang-format clang-tidy libbenchmark-dev libclang-rt-dev libgtest-dev libunicorn-dev lld \
poppler-utils python3-pyvisa python3-pyvisa-py"

if [ $# -gt 1 ]; then
  usage >&2
  exit 2
fi
case "${1-all}" in
  host) wanted=$build_packages ;;
  web) wanted=$web_packages ;;
  arm) wanted=$arm_packages ;;
  target) wanted="$build_packages $target_packages" ;;
  all) wanted="$build_packages $target_packages $check_packages" ;;
  -h | --help)
    usage
    exit 0
    ;;
  *)
    echo "install.sh: '$1' is not known" >&2
    usage >&2
    exit 2
    ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install.sh: this is no Debian system; install what these Debian packages hold: $wanted" >&2
  exit 1
fi

missing=''
for package in $wanted; do
  state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing="$missing $package"
done
if [ -z "$missing" ]; then
  echo "install.sh: nothing to install"
  exit 0
fi
echo "install.sh: missing:$missing"

if [ "$(id -u)" -ne 0 ]; then
  echo "install.sh: installing takes root; run: sudo $0${1:+ $1}" >&2
  exit 1
fi

# Only the last lines of a failure matter; a success is one line a step.
log=$(mktemp)
trap 'rm -f "$log"' EXIT
step() {
  echo "install.sh: $*"
  if ! "$@" >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    echo "install.sh: failed: $*" >&2
    exit 1
  fi
}

export DEBIAN_FRONTEND=noninteractive
step apt-get update
# How much there is to download, and how much room it takes.
# shellcheck disable=SC2086
LC_ALL=C apt-get install --no-install-recommends --assume-no $missing 2>/dev/null |
  sed -n 's/^\(Need to get\|After this operation\)/install.sh: &/p' || true
# shellcheck disable=SC2086
step apt-get install --yes --no-install-recommends $missing
echo "install.sh: done"
