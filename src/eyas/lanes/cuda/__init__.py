"""A graphics processor of NVIDIA as a device for kernels, by its driver alone.

Import it only where one is wanted: nothing else needs it.
"""

from eyas.lanes.cuda.device import CudaDevice, cuda_device, gpu_line
from eyas.lanes.cuda.driver import CudaError
from eyas.lanes.cuda.memory import CudaArray

__all__ = ["CudaArray", "CudaDevice", "CudaError", "cuda_device", "gpu_line"]
