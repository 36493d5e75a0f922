"""From data to the model of largest likelihood, with errors, for every kind of records; weights of rival models."""
