// Takes memory from the heap: the symbol gate must refuse it.
int* bad_heap() { return new int(1); }
