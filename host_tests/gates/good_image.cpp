// Does nothing that a gate objects to.
#include "emax/board/board.hpp"

extern "C" int main() { return emax::board::board().start() == emax::Status::kOk ? 0 : 1; }
