from . import cluster as cluster, engine as engine
from .cluster import WorkerCluster as WorkerCluster
