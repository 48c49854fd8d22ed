"""The paths of the API, a file a subject. A route takes a request apart, asks one function, and answers."""
