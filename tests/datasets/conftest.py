from ..kit.exported import data, dataset, exported

__all__ = ["data", "dataset", "exported"]
