# A browser: WebAssembly in a page. Its product is no image but that page.

emax_declare_board(
  CORE wasm32
  SIMULATED_BENCH
  PRODUCT product.cmake
  CHECK check.cmake)
