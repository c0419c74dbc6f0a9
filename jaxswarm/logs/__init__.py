"""Reading measured logs and preparing them for a model.

``read_log`` turns a file into a checked :class:`Log`, ``summarize`` says in numbers what it covers.
"""

from jaxswarm.logs.arrays import log_from_arrays as log_from_arrays
from jaxswarm.logs.findings import describe as describe
from jaxswarm.logs.log import Log as Log
from jaxswarm.logs.log import take as take
from jaxswarm.logs.read import LOG_FORMATS as LOG_FORMATS
from jaxswarm.logs.read import read_log as read_log
from jaxswarm.logs.reading import LogChoice as LogChoice
from jaxswarm.logs.reading import Reading as Reading
from jaxswarm.logs.reading import parse_reading as parse_reading
from jaxswarm.logs.sampling import Gap as Gap
from jaxswarm.logs.sampling import Sampling as Sampling
from jaxswarm.logs.summary import JointSummary as JointSummary
from jaxswarm.logs.summary import LogSummary as LogSummary
from jaxswarm.logs.summary import summarize as summarize
from jaxswarm.logs.write import write_log as write_log
