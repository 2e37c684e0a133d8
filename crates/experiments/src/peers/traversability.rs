//! The traversability graph of Nam, Cheong, Lee, Cho, Kim and Kim.
