# palpate.exe (preset windows-program), without a window, pictures, assimp, TBB and MPI, and palpate-fit.exe, without
# photographs. tools/make_windows_libraries makes HDF5 and Ceres; zlib is Debian's for mingw-w64.
include(palpate_headers)
palpate_headers_of(eigen3/Eigen fmt toml++ stb CLI nlohmann boost
  FOUND Eigen3 fmt tomlplusplus nlohmann_json CLI11 Boost TBB assimp ZLIB Ceres)
foreach(target IN ITEMS nlohmann_json::nlohmann_json CLI11::CLI11 Boost::headers)
  add_library(${target} ALIAS palpate_headers)
endforeach()

set(PALPATE_WINDOWS_LIBRARIES ${PROJECT_SOURCE_DIR}/build/windows-libraries CACHE PATH "Folder of tools/make_windows_libraries")
foreach(library IN ITEMS hdf5 ceres)
  if(NOT EXISTS ${PALPATE_WINDOWS_LIBRARIES}/lib/lib${library}.a)
    message(FATAL_ERROR "${PALPATE_WINDOWS_LIBRARIES}/lib/lib${library}.a: missing; tools/make_windows_libraries makes it")
  endif()
endforeach()
add_library(palpate_hdf5 INTERFACE)
target_include_directories(palpate_hdf5 SYSTEM INTERFACE ${PALPATE_WINDOWS_LIBRARIES}/include)
target_link_libraries(palpate_hdf5 INTERFACE ${PALPATE_WINDOWS_LIBRARIES}/lib/libhdf5.a
  /usr/x86_64-w64-mingw32/lib/libz.a)
add_library(PkgConfig::HDF5 ALIAS palpate_hdf5)
add_library(palpate_ceres INTERFACE)
target_include_directories(palpate_ceres SYSTEM INTERFACE ${PALPATE_WINDOWS_LIBRARIES}/include
  ${PALPATE_WINDOWS_LIBRARIES}/include/ceres/internal/miniglog)
target_compile_definitions(palpate_ceres INTERFACE MAX_LOG_LEVEL=-3)  # no messages, as in the library
target_link_libraries(palpate_ceres INTERFACE ${PALPATE_WINDOWS_LIBRARIES}/lib/libceres.a palpate_headers)
add_library(Ceres::ceres ALIAS palpate_ceres)

find_package(Threads REQUIRED)
# Boost.Asio's sockets, SHA-256, timers and the power plan: libraries of Windows.
link_libraries(ws2_32 mswsock bcrypt winmm powrprof shell32)
