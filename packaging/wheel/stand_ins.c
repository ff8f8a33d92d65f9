// Symbols that the static libraries in the wheel refer to (tools/make_wheel) and that older systems or the
// wheel lack.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

// Set to 1 by glibc 2.32 and later while a process has one thread; libstdc++ then counts references without
// atomics.
char __libc_single_threaded = 0;

// Since glibc 2.36. std::random_device of libstdc++ 12 calls it.
uint32_t arc4random(void);
uint32_t arc4random(void) {
  uint32_t bits = 0;
  if (getentropy(&bits, sizeof bits) != 0) abort();
  return bits;
}

// Debian compiles most static libraries for programs: their code reaches stdout and stderr only within the
// file that it is linked into. tools/make_wheel renames both to these copies.
FILE* palpate_stdout;
FILE* palpate_stderr;
__attribute__((constructor)) static void copy_streams(void) {
  palpate_stdout = stdout;
  palpate_stderr = stderr;
}

#define UNUSED(name) \
  void name(void);   \
  void name(void) { abort(); }
// clang-format off

// Functions of SuiteSparse (GPL), CXSparse and LAPACK. libceres.a calls them in solvers that Palpate does not choose:
// components/fit/identify uses DENSE_QR and DENSE_SCHUR with Eigen.
UNUSED(cholmod_amd) UNUSED(cholmod_analyze) UNUSED(cholmod_analyze_p) UNUSED(cholmod_camd) UNUSED(cholmod_factorize)
UNUSED(cholmod_finish) UNUSED(cholmod_free_dense) UNUSED(cholmod_free_factor) UNUSED(cholmod_free_sparse)
UNUSED(cholmod_l_finish) UNUSED(cholmod_l_free_sparse) UNUSED(cholmod_l_start) UNUSED(cholmod_print_common)
UNUSED(cholmod_solve) UNUSED(cholmod_start) UNUSED(cholmod_triplet_to_sparse) UNUSED(cholmod_zeros) UNUSED(cs_di_amd)
UNUSED(cs_di_calloc) UNUSED(cs_di_chol) UNUSED(cs_di_cholsol) UNUSED(cs_di_compress) UNUSED(cs_di_counts)
UNUSED(cs_di_cumsum) UNUSED(cs_di_etree) UNUSED(cs_di_free) UNUSED(cs_di_ipvec) UNUSED(cs_di_lsolve)
UNUSED(cs_di_ltsolve) UNUSED(cs_di_malloc) UNUSED(cs_di_multiply) UNUSED(cs_di_nfree) UNUSED(cs_di_pinv)
UNUSED(cs_di_post) UNUSED(cs_di_pvec) UNUSED(cs_di_schol) UNUSED(cs_di_sfree) UNUSED(cs_di_spfree) UNUSED(cs_di_symperm)
UNUSED(cs_di_transpose) UNUSED(dgeqrf_) UNUSED(dormqr_) UNUSED(dpotrf_) UNUSED(dpotrs_) UNUSED(dtrtrs_)
UNUSED(_Z13SuiteSparseQRIdElidlP21cholmod_sparse_structPS1_PPlP21cholmod_common_struct)

// Functions of LAPACK, BLAS and OpenGL. libopencv_core.a calls them for linear algebra and windows; components/fit/imaging only
// filters.
UNUSED(cblas_cgemm) UNUSED(cblas_dgemm) UNUSED(cblas_sgemm) UNUSED(cblas_zgemm) UNUSED(dgels_) UNUSED(dgesdd_)
UNUSED(dgesv_) UNUSED(dgetrf_) UNUSED(dposv_) UNUSED(sgels_) UNUSED(sgeqrf_) UNUSED(sgesdd_) UNUSED(sgesv_)
UNUSED(sgetrf_) UNUSED(sposv_) UNUSED(spotrf_) UNUSED(glXGetProcAddressARB)

// Since glibc 2.34. src/io/system/child_process.cc calls it for programs that a window starts; the wheel has no window.
UNUSED(posix_spawn_file_actions_addclosefrom_np)

// Functions of libunwind. libglog.a calls them for the stack after a fatal message, and then aborts.
UNUSED(_Ux86_64_getcontext) UNUSED(_ULx86_64_init_local) UNUSED(_ULx86_64_step) UNUSED(_ULx86_64_get_reg)
