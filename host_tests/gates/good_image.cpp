// Does nothing that a gate objects to.
#include "emax/board/board.hpp"

extern "C" int main() { return emax::board::start_board() == emax::Status::kOk ? 0 : 1; }
