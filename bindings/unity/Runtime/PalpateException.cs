using System;

namespace Palpate
{
    public enum ErrorKind
    {
        /// <summary>Invalid call: a wrong array, or a wrong order.</summary>
        Use = 1,
        /// <summary>Invalid scene, file or number.</summary>
        Input = 2,
        /// <summary>No memory, or another failure of the system.</summary>
        Other = 3
    }

    /// <summary>An error of the library, with its message: the field, its value and the accepted values.</summary>
    public sealed class PalpateException : Exception
    {
        public ErrorKind Kind { get; private set; }

        public PalpateException(ErrorKind kind, string message) : base(message)
        {
            Kind = kind;
        }
    }
}
