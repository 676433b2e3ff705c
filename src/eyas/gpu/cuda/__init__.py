"""A graphics processor of NVIDIA as a device for kernels, by its driver alone.

Nothing else in this room imports it: it is for those who want such a device.
"""

from eyas.gpu.cuda.device import CudaDevice, cuda_device
from eyas.gpu.cuda.driver import CudaError, gpu_line
from eyas.gpu.cuda.memory import CudaArray

__all__ = ["CudaArray", "CudaDevice", "CudaError", "cuda_device", "gpu_line"]
