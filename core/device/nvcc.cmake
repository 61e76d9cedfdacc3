# Finds nvcc, CUDA's compiler: on the path, or in one of the folders `nvcc_folders`.
find_program(DOSEKI_NVCC nvcc HINTS ${nvcc_folders})
if(NOT DOSEKI_NVCC)
  message(FATAL_ERROR "DOSEKI_INSTRUCTION_SETS: cuda needs nvcc, CUDA's compiler, which is not here: "
          "put that of NVIDIA's toolkit on the path, or take that of PyPI, pip install 'doseki[cuda]'")
endif()
