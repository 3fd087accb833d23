//! The null estimator: no decay at all. The floor row of every table and the file a new author copies.
