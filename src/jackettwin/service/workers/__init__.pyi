from . import cluster as cluster, engine as engine, stiffness as stiffness
from .cluster import WorkerCluster as WorkerCluster
