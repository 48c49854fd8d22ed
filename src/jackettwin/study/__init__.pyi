from .document import (
    run_document as run_document,
    update_document as update_document,
)
from .follow import follow as follow
from .result import DampingExcess as DampingExcess, TwinResult as TwinResult
from .run import count_steps as count_steps, run_twin as run_twin
