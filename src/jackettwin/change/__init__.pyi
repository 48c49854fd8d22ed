from .changed_structures import Happening as Happening, Standing as Standing, with_mass as with_mass
from .ground import Ground as Ground
from .judge import JUDGED as JUDGED, Days as Days, Judged as Judged, finding_of as finding_of, judge as judge
